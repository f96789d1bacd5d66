"""A program on a machine with a servo, dry friction or a supply is planned with one filter."""
import json
import subprocess

from looking import check
from program import Program

AXIS = "mass_kg = 20\nforce_max_N = 2000\n"
LOADS = {"a servo": AXIS + "servo_gain_1_s = 200\nvelocity_feedforward = 0.9\n",
         "dry friction": AXIS + "coulomb_N = 40\n",
         "a supply": AXIS + "[machine]\npower_total_max_W = 500\n"}


def with_loads(accdec, home, code, task):
    for name, lines in LOADS.items():
        file, out = home / "loads.toml", home / "loads.json"
        file.write_text(task.read_text() + lines)
        planned = subprocess.run([accdec, "--quiet", "program", code, "--task", file, "--plan", "fixed", "--json", out],
                                 capture_output=True, text=True)
        check(planned.returncode == 0, f"{name}: the command line plans it {planned.stderr.strip()}".strip())
        program = Program(accdec, code, "--task", file, cwd=home)
        plans = json.loads(program.ask("GET", program.path + "start")[1])["program"]["plans"]
        program.end()
        took = json.loads(out.read_text())["cycle_time_s"]
        check([(p["plan"], p["cycle_time_s"]) for p in plans if p["plan"] == "fixed"] == [("fixed", took)],
              f"{name}: the page has that plan, {took} s")
