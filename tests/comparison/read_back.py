#!/usr/bin/env python3
"""Solves instances of `accdec instances` with programs that are not ours: read_back.py TOOL FILE.

TOOL is cbc, glpsol, highs (that of SciPy), csdp, cvxopt or scip. Prints the optimum, "infeasible", or "missing" if the tool is not installed.
"""
import importlib.util
import os
import re
import shutil
import subprocess
import sys
import tempfile


def run(*command):
    return subprocess.run(command, capture_output=True, text=True, timeout=120).stdout


def cbc(file):
    out = run("cbc", file, "solve")
    if re.search(r"infeasible", out, re.I):
        return "infeasible"
    found = re.findall(r"(?:Optimal - objective value|Objective value:) *(\S+)", out)
    return found[-1] if found and "Coin0008I accdec read with 0 errors" in out else out[-2000:]


def glpsol(file):
    with tempfile.TemporaryDirectory() as folder:
        answer = os.path.join(folder, "answer")
        out = run("glpsol", "--freemps", file, "-o", answer)
        if re.search(r"NO (PRIMAL )?FEASIBLE SOLUTION", out):
            return "infeasible"
        with open(answer, encoding="ascii") as text:
            return re.search(r"Objective: +\S+ = (\S+)", text.read())[1]


def csdp(file):
    out = run("csdp", file)
    if re.search(r"SDP is (primal|dual) infeasible", out):
        return "infeasible"
    primal, dual = (float(re.search(kind + r" objective value: *(\S+)", out)[1]) for kind in ("Primal", "Dual"))
    return f"{primal!r} {dual!r}"


def scip(file):
    with tempfile.TemporaryDirectory() as folder:  # AMPL solvers write beside the problem
        out = run("scip", shutil.copy(file, folder), "-AMPL")
    solved = re.search(r"SCIP Status +: problem is solved \[(optimal solution found|infeasible)\]", out)
    if solved and solved[1] == "infeasible":
        return "infeasible"
    return re.search(r"Primal Bound +: (\S+)", out)[1] if solved else out[-2000:]


def highs(file):
    import highs_solver
    found = highs_solver.solve(file, 60)
    return "infeasible" if found.status == 2 else repr(found.fun)


def cvxopt(file):
    import cone_solver
    status, objective, _ = cone_solver.solve(file)
    return {"primal infeasible": "infeasible", "optimal": repr(objective)}.get(status, status)


def main():
    tool, file = sys.argv[1:]
    sys.path.insert(0, os.path.join(os.path.dirname(__file__), "..", "..", "problems", "suite"))
    module = {"cvxopt": "cvxopt", "highs": "scipy"}.get(tool)
    if not (importlib.util.find_spec(module) if module else shutil.which(tool)):
        return print("missing")
    print({"cbc": cbc, "glpsol": glpsol, "highs": highs, "csdp": csdp, "cvxopt": cvxopt, "scip": scip}[tool](file))


main()
