"""The reference pages of the guide: keys of files and commands as the program prints them, the Python module from its
docstrings (Sphinx autodoc), the C++ library from the comments of its headers (doxygen, Breathe)."""
import re
import subprocess
import textwrap
import xml.etree.ElementTree as ElementTree

kinds = {
    "task": "What the machine may do and what is asked of it. Read by most commands.",
    "study": "Many tasks made from one: `accdec study`.",
    "suite": "Problems and the solvers that are compared on them: `accdec compare`.",
    "result": "What `accdec design` and `accdec evaluate` write with `--json`. SI units.",
}

# All public headers, by what they are for.
headers = {
    "Tasks and results": "task.hpp machine.hpp result.hpp verify.hpp",
    "Designing": "design.hpp family.hpp certificate.hpp",
    "Filters and motion": "filter.hpp corner.hpp",
    "Whole programs": "program.hpp simulate.hpp",
    "Nonlinear problems and solvers": "problem.hpp solver.hpp",
    "Files": "files.hpp",
}

# "///< > 0" is no quotation of Markdown.
doxygen_settings = r"""
PROJECT_NAME = accdec
INPUT = {headers}
STRIP_FROM_PATH = {library}
OUTPUT_DIRECTORY = {out}
GENERATE_HTML = NO
GENERATE_LATEX = NO
GENERATE_XML = YES
XML_PROGRAMLISTING = NO
MAX_INITIALIZER_LINES = 1
INPUT_FILTER = "sed 's,\(///<*\) >,\1 \\>,'"
EXTRACT_ALL = YES
QUIET = YES
WARN_IF_UNDOCUMENTED = NO
WARN_IF_INCOMPLETE_DOC = NO
WARN_AS_ERROR = FAIL_ON_WARNINGS
"""


columns = 120  # of printed output, as wide.css has room for


def folded(output):
    """Long sentences on several lines, below their first word. Rows of tables stay as they are."""
    lines = []
    for line in output.splitlines():
        gaps = [gap.end() for gap in re.finditer(r"(?<=\S) {2,}", line)]
        if len(line) <= columns or len(gaps) > 1:
            lines.append(line)
            continue
        left = len(line) - len(line.lstrip())
        indent = " " * (gaps[0] if gaps else left if left > 8 else left + 2)
        lines += textwrap.wrap(line, columns, subsequent_indent=indent, break_long_words=False, break_on_hyphens=False)
    return "\n".join(lines)


def said(*command):
    return subprocess.run([str(word) for word in command], check=True, text=True, stdout=subprocess.PIPE).stdout


def parts_of(printed):
    """The tables of a file one by one, below their names, instead of one table whose first column names them."""
    head, *rows = [[cell.strip() for cell in re.split(r"(?<!\\)\|", line)[1:-1]] for line in printed.splitlines()]
    parts = []
    for table, *cells in rows[1:]:
        if table:
            parts.append(f"### {'Top' if table == 'top' else table}\n")
            if table != "top":
                meaning = cells[4]
                parts.append(f"{meaning[0].upper()}{meaning[1:]}.\n")
        if cells[0].startswith("as "):
            parts.append(f"Its keys are those of {cells[0].removeprefix('as ').removeprefix('of ')}.\n")
        elif not table or table == "top":
            if not parts[-1].startswith("|"):
                parts += [f"| {' | '.join(head[1:])} |", f"|{'---|' * len(cells)}"]
            parts.append(f"| {' | '.join(cells)} |")
    text = "\n".join(parts)
    return re.sub(r"(?:^\|.*\n?)+", lambda found: f"```{{table}}\n:class: keys\n\n{found[0].rstrip()}\n```\n\n", text,
                  flags=re.MULTILINE)


def keys(program):
    parts = ["# Keys of files\n", "`accdec schema KIND --markdown` prints these keys, and without `--markdown` a "
             "JSON Schema for editors. Every command that reads a file refuses keys that are not here.\n"]
    for kind, what in kinds.items():
        parts.append(f"## {kind.capitalize()}\n\n{what}\n\n{parts_of(said(program, 'schema', kind, '--markdown'))}")
    return "\n".join(parts)


def commands(program):
    overview = said(program, "--help")
    names = re.findall(r"^  (\w[\w-]*) ", overview.partition("\nSubcommands:\n")[2], flags=re.M)
    if not names:
        raise SystemExit("no subcommands in `accdec --help`")
    parts = [f"# Commands\n\n```text\n{folded(overview.rstrip())}\n```\n"]
    for name in names:
        parts.append(f"## accdec {name}\n\n```text\n{folded(said(program, name, '--help').strip())}\n```\n")
    return "\n".join(parts)


def python_module(built):
    title = "Python module\n=============\n\n"
    if not built:
        return title + "The Python module was not built with this guide (``-DACCDEC_PYTHON=ON`` does); " \
                       "``help(accdec)`` in Python shows what stands here.\n"
    return title + ".. automodule:: accdec\n   :members:\n"


def members(xml):
    """Of every header what it declares outside classes, as Breathe's directives: {header: {line: directive}}."""
    found, classes = {}, {}
    for path in xml.glob("*.xml"):
        for compound in ElementTree.parse(path).getroot().iter("compounddef"):
            if compound.get("kind") in ("class", "struct"):
                classes[compound.find("compoundname").text] = compound
            if compound.get("kind") != "namespace":
                continue
            for member in compound.iter("memberdef"):
                kind, place = member.get("kind"), member.find("location")
                name = f"{compound.find('compoundname').text}::{member.findtext('name')}"
                if kind == "function":
                    name += member.findtext("argsstring")
                found.setdefault(place.get("file"), {})[int(place.get("line"))] = f".. doxygen{kind}:: {name}\n"
    for name, compound in classes.items():
        if name.rpartition("::")[0] not in classes:  # else it stands within that class
            place = compound.find("location")
            directive = f".. doxygen{compound.get('kind')}:: {name}\n   :members:\n   :undoc-members:\n"
            found.setdefault(place.get("file"), {})[int(place.get("line"))] = directive
    return found


def cpp_library(library, out):
    """Runs doxygen, whose XML Breathe reads from out/xml; its warnings are errors."""
    out.mkdir()
    listed = " ".join(headers.values()).split()
    settings = out / "Doxyfile"
    settings.write_text(doxygen_settings.format(library=library, out=out,
                                                headers=" ".join(f"{library}/accdec/{name}" for name in listed)))
    if subprocess.run(["doxygen", settings]).returncode != 0:
        raise SystemExit("the comments of the headers have errors")
    found = members(out / "xml")
    parts = ["C++ library\n===========\n\nSI units throughout. ``find_package(accdec REQUIRED)`` and "
             "``accdec::accdec`` in CMake. These are\nall its headers.\n"]
    for title, names in headers.items():
        parts.append(f"{title}\n{'-' * len(title)}\n")
        for name in names.split():
            directives = found.get(f"accdec/{name}")
            if not directives:
                raise SystemExit(f"doxygen found nothing in {name}")
            parts += [f"{name}\n{'~' * len(name)}\n\n``#include <accdec/{name}>``\n"]
            parts += [directives[line] for line in sorted(directives)]
    return "\n".join(parts)


def write_reference(folder, program, library, doxygen, python):
    folder.mkdir()
    (folder / "keys.md").write_text(keys(program))
    (folder / "commands.md").write_text(commands(program))
    (folder / "python.rst").write_text(python_module(python))
    (folder / "cpp.rst").write_text(cpp_library(library, doxygen))
