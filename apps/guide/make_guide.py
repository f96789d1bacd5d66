#!/usr/bin/python3 -B
"""Builds the guide: runs every example, puts what it printed and drew onto its page, and calls Sphinx with warnings as
errors. An example that exits with another code than 0 fails the build.

usage: make_guide.py PROGRAM OUT [--programs DIR] [--python DIR]
  PROGRAM     the accdec program that the examples run
  OUT         folder for the sources as run and for html/
  --programs  folder of the compiled programs/*.cpp; without it C++ examples are shown and not run
  --python    folder that the Python module is in; without it Python examples are shown and not run

Pages are Markdown. A code block {run} is a shell script, {python} a Python program, {cpp} the name of a C++ program of
programs/; all run in a folder of the page's own, in which `problems` leads to the shipped problems. Figures (.svg) that
a block makes stand behind it. A file of problems/examples/ becomes a page: comments are its text, commands are blocks.
Reference pages: see reference.py.
"""
import argparse
import os
import pathlib
import re
import shutil
import subprocess
import sys

from reference import folded, write_reference

guide = pathlib.Path(__file__).resolve().parent
root = guide.parent.parent


class Page:
    """The folder one page's blocks run in, and where its figures go."""

    def __init__(self, name, out, arguments):
        self.name, self.python, self.programs = name, arguments.python, arguments.programs
        self.folder = out / "run" / name
        self.source = out / "source"
        self.figures = self.source / "figures" / name
        self.folder.mkdir(parents=True)
        self.figures.mkdir(parents=True)
        (self.folder / "problems").symlink_to(root / "problems")
        tools = self.folder / ".bin"
        tools.mkdir()
        (tools / "accdec").symlink_to(arguments.program)
        self.environment = dict(os.environ, PATH=f"{tools}:{os.environ['PATH']}", NO_COLOR="1")
        if self.python:
            self.environment["PYTHONPATH"] = str(self.python)

    def run(self, command, shown, language):
        before = set(self.folder.rglob("*.svg"))
        done = subprocess.run(command, cwd=self.folder, env=self.environment, text=True, timeout=300,
                              stdout=subprocess.PIPE, stderr=subprocess.STDOUT, stdin=subprocess.DEVNULL)
        if done.returncode != 0:
            sys.exit(f"{self.name}: exit code {done.returncode} of\n{shown}\n{done.stdout}")
        text = f"```{language}\n{shown.rstrip()}\n```\n"
        if done.stdout.strip():
            text += f"\n```text\n{folded(done.stdout.rstrip())}\n```\n"
        for figure in sorted(set(self.folder.rglob("*.svg")) - before):
            shutil.copy(figure, self.figures)
            text += f"\n![{figure.stem}](/figures/{self.name}/{figure.name})\n"
        return text

    def shell(self, script):
        return self.run(["sh", "-e", "-c", script], script, "sh")

    def python_program(self, script):
        if not self.python:
            return f"```python\n{script.rstrip()}\n```\n"
        return self.run([sys.executable, "-c", script], script, "python")

    def cpp_program(self, name):
        name = name.strip()
        text = (guide / "programs" / f"{name}.cpp").read_text()
        if not self.programs:
            return f"```cpp\n{text.rstrip()}\n```\n"
        return self.run([self.programs / f"guide_{name}"], text, "cpp")

    def markdown(self, text):
        makers = {"run": self.shell, "python": self.python_program, "cpp": self.cpp_program}

        def block(match):
            return makers[match[1]](match[2]).rstrip("\n")
        return re.sub(r"^```\{(run|python|cpp)\}\n(.*?)^```$", block, text, flags=re.S | re.M)

    def example(self, text):
        """A shell script: runs of comments and of commands in turn. Here-documents may hold # lines."""
        lines = text.splitlines()[1:]
        title = lines.pop(0).lstrip("# ")
        parts, prose, code, end = [f"# {title}\n"], [], [], None

        def flush():
            if prose:
                parts.append("\n".join(prose) + "\n")
            if code:
                parts.append(self.shell("\n".join(code) + "\n"))
            prose.clear(), code.clear()
        for line in lines:
            if end is None and line.startswith("#"):
                if code:
                    flush()
                prose.append(line[2:])
                continue
            if prose:
                flush()
            here = re.search(r"<<'(\w+)'", line)
            end = here[1] if here and end is None else None if line == end else end
            code.append(line)
        flush()
        return "\n".join(parts)


def arguments_of_line():
    parser = argparse.ArgumentParser(usage=__doc__)
    parser.add_argument("program", type=pathlib.Path)
    parser.add_argument("out", type=pathlib.Path)
    parser.add_argument("--programs", type=pathlib.Path)
    parser.add_argument("--python", type=pathlib.Path)
    arguments = parser.parse_args()
    for name, path in vars(arguments).items():
        setattr(arguments, name, path and path.resolve())
    return arguments


def complete_styles(folder):
    """Debian's theme imports a style by a path from the root, which no disk and few web servers have."""
    for style in folder.glob("*.css"):
        style.write_text(re.sub(r"@import url\((/[^)]*)\);", lambda found: imported(found[1]), style.read_text()))


def complete_scripts(folder):
    """Debian's theme leaves its script a module that imports a classic one, and pages load it as a classic script."""
    script = folder / "furo.js"
    line = re.compile(r'^import Gumshoe from "\./([\w.-]+)";\n', re.M)
    # A function stands for the text, as a pattern would read its backslashes.
    script.write_text(line.sub(lambda found: (folder / found[1]).read_text() + "\n", script.read_text()))


def imported(path):
    file = pathlib.Path("/usr/share" + path)
    return file.read_text() if file.exists() else ""


def main():
    arguments = arguments_of_line()
    out, doxygen = arguments.out, arguments.out / "doxygen"
    shutil.rmtree(out, ignore_errors=True)
    source = out / "source"
    (source / "examples").mkdir(parents=True)
    shutil.copy(guide / "conf.py", source)
    shutil.copytree(guide / "static", source / "static")
    write_reference(source / "reference", arguments.program, root / "lib/include", doxygen, arguments.python)
    for path in sorted(guide.glob("*.md")):
        (source / path.name).write_text(Page(path.stem, out, arguments).markdown(path.read_text()))
    for path in sorted((root / "problems" / "examples").iterdir()):
        page = Page(path.name, out, arguments)
        (source / "examples" / f"{path.name}.md").write_text(page.example(path.read_text()))
    environment = dict(os.environ, ACCDEC_DOXYGEN_XML=str(doxygen / "xml"), PYTHONPATH=str(arguments.python or ""))
    command = [sys.executable, "-m", "sphinx", "-q", "-W", "--keep-going", "-b", "html", str(source), str(out / "html")]
    if subprocess.run(command, env=environment).returncode != 0:
        sys.exit("the guide has errors")
    complete_styles(out / "html/_static/styles")
    complete_scripts(out / "html/_static/scripts")
    print(f"the guide is in {out / 'html' / 'index.html'}")


main()
