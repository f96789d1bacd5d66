"""The programs and limits of the league: copies that all planners read alike, task files of accdec, samples of motions."""
import pathlib
import re
import subprocess
import tomllib

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parent.parent
PACKAGE = pathlib.Path("/usr/share/linuxcnc/ncfiles")
LEAGUE = tomllib.loads((HERE / "league.toml").read_text())
VELOCITY = LEAGUE["velocity_max_mm_s"]  # of every axis


def fair(program, folder):
    """A copy with G61.1 before its last move: LinuxCNC would else keep half its acceleration there for a blend that
    never comes. Where a program has loops or calls, the last line is not the last move, so its copy has none."""
    lines = pathlib.Path(program).read_text().splitlines()
    words = [line.split("(")[0].upper() for line in lines]
    moves = [i for i, line in enumerate(words) if any(c in line for c in "XYZ")]
    if not any("G61.1" in line for line in words) and not any(re.match(r"\s*O", line) for line in words):
        lines.insert(moves[-1], "G61.1")
    copy = folder / pathlib.Path(program).name
    copy.write_text("\n".join(lines) + "\n")
    return copy


def without_tools(program, folder, tolerance):
    """A copy of a program of LinuxCNC's package with a tolerance from its first line on, and without tool changes,
    spindle, coolant and program stops, which move nothing. Its own G64 without P would ask for no tolerance at all."""
    lines = ["G21 G64 P%g" % tolerance]
    text = pathlib.Path(program).read_text(errors="replace")
    if not re.search(r"(?i)G0*2[01](?![\d.])", text):
        lines.append("G20")  # as a machine in inches reads it
    for line in text.splitlines():
        code = re.sub(r"\(.*?\)|;.*|^%.*", "", line)
        for words in (r"G0*64(?![\d.])(\s*P\s*[\d.]+)?", r"(T\s*(\d+|#<\w+>)|M\s*0*[013-9](?!\d))", r"S\s*(\d+|#<\w+>)(?=\s*$)"):
            code = re.sub(r"(?i)(?<![#<a-z_])" + words, "", code)
        lines.append(code)
    lines.append("M2")  # the percent sign that ended it is gone
    copy = folder / pathlib.Path(program).name
    copy.write_text("\n".join(lines) + "\n")
    return copy


def cases(accdec, folder):
    """(name, program, acceleration in mm/s^2, jerks in mm/s^3 with 0 for none) of everything in league.toml."""
    found = []
    for group in LEAGUE["programs"]:
        programs = []
        for path in group.get("files", []):
            programs.append((path.removeprefix("problems/program/").removeprefix("tests/peers/"), ROOT / (path + ".ngc")))
        for words in group.get("generate", []):
            kind, *options = words.split()
            program = folder / (kind + "-generated.ngc")
            subprocess.check_call([accdec, "generate", kind, *options, *group["options"].split(), "--out", str(program)])
            programs.append((kind + "-generated", program))
        for name in group.get("package", []):
            if (PACKAGE / (name + ".ngc")).exists():
                programs.append(("package/" + name, without_tools(PACKAGE / (name + ".ngc"), folder, group["tolerance_mm"])))
        for name, program in programs:
            found.append((name, program, 1000, group["jerks"]))
            found += [(name, program, acceleration, [0]) for acceleration in group.get("accelerations", [])]
    return found


def task_file(folder, acceleration, jerk):
    path = folder / ("limits-%d-%s.toml" % (acceleration, jerk or "none"))
    path.write_text(
        "sample_period_ms = 1.0\n[[axis]]\nvelocity_max_mm_s = %d\nacceleration_max_mm_s2 = %d\n%s"
        % (VELOCITY, acceleration, "jerk_max_mm_s3 = %d\n" % jerk if jerk else "")
    )
    return path


def samples_of(path):
    """Columns x_mm, y_mm, z_mm of a sample file; an axis that never moves may be missing."""
    import numpy as np

    with open(path) as file:
        names = file.readline().strip().split(",")
        axes = [a for a in ("x_mm", "y_mm", "z_mm") if a in names]
        if not axes:
            raise ValueError("%s: the first line names none of x_mm, y_mm, z_mm" % path)
        lines = [line for line in file if line.strip()]
    if not lines:
        raise ValueError("%s: no samples" % path)
    table = np.loadtxt(lines, delimiter=",", usecols=[names.index(a) for a in axes], ndmin=2)
    if not np.isfinite(table).all():
        raise ValueError("%s: a position is no number" % path)
    motion = np.zeros((len(table), 3))
    for column, axis in enumerate(axes):
        motion[:, "xyz".index(axis[0])] = table[:, column]
    return motion
