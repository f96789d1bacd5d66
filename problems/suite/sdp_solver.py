#!/usr/bin/env python3
"""Solves a cone program for `accdec compare` with a semidefinite solver: sdp_solver.py TOOL PROBLEM.cbf ANSWER, where TOOL
is csdp, sdpa or dsdp5.

Equations are eliminated by an orthogonal basis of their solutions, because these solvers need an interior. A rotated
cone |u|^2 <= 2 s t is the block [2s u'; u tI]. This is an example of an [[external]] solver: see external.toml.
"""
import os
import re
import subprocess
import sys

import numpy
from cone_solver import read

# A file of the working folder that sdpa reads: an accuracy of 1e-10, and all digits of y. With less than its own 1e-8, csdp
# ends at the edge of what it can.
PARAMETERS = {
    "param.sdpa": ["100 maxIteration", "1e-10 epsilonStar", "1e4 lambdaStar", "2.0 omegaStar", "-1e5 lowerBound",
                   "1e5 upperBound", "0.1 betaStar", "0.2 betaBar", "0.9 gammaStar", "1e-10 epsilonDash",
                   "%+20.16e xPrint", "%+8.3e XPrint", "%+8.3e YPrint", "%+10.16e infPrint"]}


def dense(rows, n):
    table = numpy.zeros((len(rows), n + 1))  # the last column is the constant
    for r, (form, constant) in enumerate(rows):
        for i, value in form.items():
            table[r, i] = value
        table[r, n] = constant
    return table


def blocks_of(cones, rows, n):
    """Equations, inequalities, and rotated cones, as tables of forms."""
    equal, linear, rotated, at = [], [], [], 0
    for kind, size in cones:
        part = rows[at:at + size]
        at += size
        if kind == "QR":
            rotated.append(dense(part, n))
        else:
            (equal if kind == "L=" else linear).extend(part)
    return dense(equal, n), dense(linear, n), rotated


def substitution(equal, n):
    """x = [basis point] (y, 1): every solution of the equations."""
    a, b = equal[:, :n], -equal[:, n]
    point = numpy.linalg.lstsq(a, b, rcond=None)[0] if len(a) else numpy.zeros(n)
    _, values, right = numpy.linalg.svd(a) if len(a) else (None, numpy.zeros(0), numpy.eye(n))
    return numpy.column_stack([right[int((values > 1e-12).sum()):].T, point])


def text_of(costs, linear, rotated):
    """SDPA's sparse format: minimise costs.y with sum F_i y_i - F_0 positive semidefinite."""
    m = len(costs)
    sizes = [-len(linear)] + [len(cone) - 1 for cone in rotated]
    lines = [f"{m}", f"{len(sizes)}", " ".join(map(str, sizes)), " ".join(f"{float(c)!r}" for c in costs)]

    def add(block, i, j, form):
        for k, value in enumerate(form):
            if value != 0.0:
                number, value = (0, -value) if k == m else (k + 1, value)
                lines.append(f"{number} {block} {i} {j} {float(value)!r}")

    for r, form in enumerate(linear):
        add(1, r + 1, r + 1, form)
    for b, cone in enumerate(rotated):
        add(b + 2, 1, 1, 2 * cone[0])
        for u in range(2, len(cone)):
            add(b + 2, 1, u, cone[u])
            add(b + 2, u, u, cone[1])
    return "\n".join(lines) + "\n"


def solve(tool, text, m):
    """Claim and y."""
    with open("problem.dat-s", "w", encoding="ascii") as out:
        out.write(text)
    for name, values in PARAMETERS.items():
        with open(name, "w", encoding="ascii") as out:
            out.write("\n".join(values) + "\n")
    commands = {"csdp": ["csdp", "problem.dat-s", "y"], "sdpa": ["sdpa", "-ds", "problem.dat-s", "-p", "param.sdpa", "-o", "y"],
                "dsdp5": ["dsdp5", "problem.dat-s", "-save", "y", "-gaptol", "1e-10"]}
    said = subprocess.run(commands[tool], capture_output=True, text=True, check=False).stdout
    if not os.path.exists("y"):
        return "failed", []
    with open("y", encoding="ascii") as answer:
        found = answer.read()
    words = said + found
    if re.search(r"SDP is (primal|dual) infeasible|Unbounded, (Dual|Primal) Infeasible|= pdINF|pINF|dINF|UNBD", words):
        return "infeasible", []
    solved = re.search(r"Success: SDP solved|pdOPT|DSDP Converged", words)
    numbers = re.search(r"xVec = \s*\{([^}]*)\}", found)[1].replace(",", " ") if tool == "sdpa" else found.split("\n")[0]
    return "solved" if solved else "acceptable", [float(word) for word in numbers.split()][:m]


def main():
    tool, problem, answer = sys.argv[1:]
    n, costs, _, cones, rows = read(problem)
    equal, linear, rotated = blocks_of(cones, rows, n)
    turned = substitution(equal, n)
    m = turned.shape[1] - 1
    at_point = numpy.vstack([turned, numpy.eye(m + 1)[-1]])
    cost = numpy.array([costs.get(i, 0.0) for i in range(n)]) @ turned[:, :m]
    claim, y = solve(tool, text_of(cost, linear @ at_point, [cone @ at_point for cone in rotated]), m)
    x = turned @ numpy.append(y, 1.0) if y else []
    with open(answer, "w", encoding="ascii") as out:
        print(claim, *map(float, x), sep="\n", file=out)


main()
