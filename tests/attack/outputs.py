"""Outputs that must not be written, or cannot be: onto inputs, onto each other, onto full disks; many writers at once;
links."""
import os
import resource
import signal
import subprocess
from pathlib import Path

from harness import leftovers, read_json

TASK = """sample_period_ms = 1.0
[[axis]]
acceleration_max_mm_s2 = 6000
jerk_max_mm_s3 = 500000
[[corner]]
name = "A"
angle_deg = 95
feed_in_mm_min = 6000
error_max_um = 50
"""
MACHINE = TASK.split("[[corner]]")[0] + "[filter]\nkind = \"boxcar\"\norder = 20\n"
PROGRAM = "G21 G90 G17 G64 P0.05\nG1 F3000 X10 Y0\nG1 X10 Y10\nG1 X0 Y10\nM2\n"


def _small_files():
    """A full disk for one process: no file may grow beyond 64 bytes, and that is an error rather than a signal."""
    signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
    resource.setrlimit(resource.RLIMIT_FSIZE, (64, 64))


def _commands(p):
    """Commands with one output each: what stands before the name of the output."""
    return [
        ("design", p("task.toml"), "-q", "--json"),
        ("evaluate", p("given.toml"), "-q", "--json"),
        ("export", p("result.json"), "--format", "json", "--out"),
        ("export", p("result.json"), "--format", "c", "--out"),
        ("plot", p("result.json"), "--out"),
        ("generate", "star", "--blocks", "50", "--out"),
    ] + [
        ("program", p("part.ngc"), "--task", p("machine.toml"), "-q", o)
        for o in ("--json", "--samples", "--delays", "--emit", "--figure")
    ]


def make_inputs(attack):
    p = attack.path
    Path(p("task.toml")).write_text(TASK)
    Path(p("given.toml")).write_text(
        TASK.replace("error_max_um", "delay_samples = 12\nerror_max_um") + "[filter]\nkind = \"boxcar\"\norder = 30\n"
    )
    Path(p("machine.toml")).write_text(MACHINE)
    Path(p("part.ngc")).write_text(PROGRAM)
    code, _, err = attack.run("design", p("task.toml"), "--json", p("result.json"), "-q")
    if code != 0:
        attack.fail(f"the shipped example ends with {code}: {err}")
    return ["task.toml", "given.toml", "machine.toml", "part.ngc", "result.json"]


def _suffix(command):
    return ".svg" if command[0] == "plot" or command[-1] == "--figure" else ".out"


def _refused(attack, inputs, command, target, what):
    """The command must end with 2 and leave every input and the folder as they were."""
    before = {name: Path(attack.path(name)).read_bytes() for name in inputs}
    names = os.listdir(attack.work)
    code, _, _ = attack.run(*command, target)
    attack.count("refusals asked for")
    if code != 2:
        attack.fail(f"{what}: exit {code}: {command[0]} {command[-1]} {os.path.basename(target)}")
    for name, content in before.items():
        if Path(attack.path(name)).read_bytes() != content:
            attack.fail(f"{what}: {name} was changed by {command[0]} {command[-1]}")
            Path(attack.path(name)).write_bytes(content)
    if leftovers(attack.work, names):
        attack.fail(f"{what}: left {leftovers(attack.work, names)}")


def _onto_inputs(attack, inputs, command):
    """By name, by another spelling of it, by a hard link and by a symbolic link."""
    for source in [a for a in command if a.startswith(str(attack.work))]:
        suffix = _suffix(command) if _suffix(command) == ".svg" else ""
        if not suffix:
            _refused(attack, inputs, command, source, "an input")
            _refused(
                attack,
                inputs,
                command,
                os.path.join(attack.work, ".", os.path.basename(source)),
                "an input, spelt otherwise",
            )
        for name, link in (("hard" + suffix, os.link), ("soft" + suffix, os.symlink)):
            link(source, attack.path(name))
            _refused(attack, inputs, command, attack.path(name), f"a {name} link to an input")
            os.unlink(attack.path(name))


def _onto_each_other(attack, inputs):
    p = attack.path
    options = ("--json", "--samples", "--delays", "--emit")
    for a in options:
        for b in options:
            if a < b:
                command = ("program", p("part.ngc"), "--task", p("machine.toml"), "-q", a, p("both"), b)
                _refused(attack, inputs, command, p("both"), "two outputs of one name")


def _cannot_be_written(attack, inputs, command):
    p = attack.path
    target = p("target" + _suffix(command))
    for place, what in (
        (os.path.join(p("missing"), "x.svg"), "a missing folder"),
        (str(attack.work), "a folder"),
        ("", "an empty name"),
    ):
        _refused(attack, inputs, command, place, what)
    if _suffix(command) != ".svg":
        _refused(attack, inputs, command, "/dev/full", "a full device")
    Path(target).write_text("old")
    names = os.listdir(attack.work)
    code, _, _ = attack.run(*command, target, preexec_fn=_small_files)
    attack.count("full disks")
    if code != 2:
        attack.fail(f"full disk: exit {code}: {command[0]} {command[-1]}")
    if Path(target).read_text() != "old" or leftovers(attack.work, names):
        attack.fail(f"full disk: old file lost or {leftovers(attack.work, names)} left by {command[0]} {command[-1]}")
    os.unlink(target)


def _planted_links(attack, command):
    """Temporaries that somebody foresaw and laid as links to a victim."""
    target, victim = attack.path("target" + _suffix(command)), attack.path("victim")
    Path(victim).write_text("precious")
    for ending in (".part", ".tmp", ".part0", "~"):
        os.symlink(victim, target + ending)
    attack.run(*command, target)
    attack.count("planted links")
    if Path(victim).read_text() != "precious":
        attack.fail(f"wrote through a planted link: {command[0]} {command[-1]}")
    for name in os.listdir(attack.work):
        if name.startswith("target") or name == "victim":
            os.unlink(attack.path(name))


def _full_standard_output(attack, command):
    with open("/dev/full", "wb") as full:
        code = subprocess.run(
            [attack.binary, *command], stdout=full, stderr=subprocess.DEVNULL, stdin=subprocess.DEVNULL
        ).returncode
    attack.count("full standard outputs")
    if code != 2:
        attack.fail(f"full standard output: exit {code}: {' '.join(command)}")


def race(attack, writers=8):
    """Many processes writing one file: all end well, and the file is whole."""
    target = attack.path("raced.json")
    names = set(os.listdir(attack.work)) | {"raced.json"}
    running = [attack.start("design", attack.path("task.toml"), "-q", "--json", target) for _ in range(writers)]
    codes = [process.wait() for process in running]
    attack.count("racing writers", writers)
    if any(codes):
        attack.fail(f"racing writers ended with {codes}")
    try:
        read_json(target)
    except ValueError:
        attack.fail("a raced file is not whole", target)
    if leftovers(attack.work, names):
        attack.fail(f"racing writers left {leftovers(attack.work, names)}")


def run(attack):
    inputs = make_inputs(attack)
    p = attack.path
    while attack.more():
        commands = _commands(p)
        step = attack.case % (len(commands) + 3)
        if step < len(commands):
            _onto_inputs(attack, inputs, commands[step])
            _cannot_be_written(attack, inputs, commands[step])
            _planted_links(attack, commands[step])
        elif step == len(commands):
            _onto_each_other(attack, inputs)
            for command in (
                ("design", p("task.toml")),
                ("evaluate", p("given.toml")),
                ("verify", p("result.json")),
                ("solvers",),
                ("program", p("part.ngc"), "--task", p("machine.toml")),
                ("generate", "star", "--blocks", "50"),
                ("design", p("task.toml"), "--json", "-"),
                ("--help",),
                ("--version",),
            ):
                _full_standard_output(attack, command)
        else:
            race(attack)
