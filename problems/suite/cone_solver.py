#!/usr/bin/env python3
"""Solves a cone program for `accdec compare`: cone_solver.py PROBLEM.cbf ANSWER, with Debian's python3-cvxopt.

This is an example of an [[external]] solver with `reads = "cbf"` and `answer = "values"`: see external.toml.
"""
import sys


def read(file):
    """Columns, costs, and rows by cone, of a CBF file: http://cblib.zib.de/format.pdf. Every row is a map of coefficients
    and a constant."""
    with open(file, encoding="ascii") as text:
        tokens = iter(text.read().split())
    costs, cones, entries, constants, n, constant = {}, [], [], {}, 0, 0.0
    for word in tokens:
        if word == "VER":
            assert next(tokens) == "1"
        elif word == "OBJSENSE":
            assert next(tokens) == "MIN"
        elif word == "VAR":
            n, _, kind, _ = int(next(tokens)), next(tokens), next(tokens), next(tokens)
            assert kind == "F"
        elif word == "CON":
            next(tokens)
            cones = [(next(tokens), int(next(tokens))) for _ in range(int(next(tokens)))]
        elif word == "OBJACOORD":
            costs = dict((int(next(tokens)), float(next(tokens))) for _ in range(int(next(tokens))))
        elif word == "OBJBCOORD":
            constant = float(next(tokens))
        elif word == "ACOORD":
            entries = [(int(next(tokens)), int(next(tokens)), float(next(tokens))) for _ in range(int(next(tokens)))]
        elif word == "BCOORD":
            constants = dict((int(next(tokens)), float(next(tokens))) for _ in range(int(next(tokens))))
        else:
            raise ValueError(f"{word} is not known here")
    rows = [({}, constants.get(r, 0.0)) for r in range(sum(size for _, size in cones))]
    for r, i, value in entries:
        rows[r][0][i] = rows[r][0].get(i, 0.0) + value
    return n, costs, constant, cones, rows


def combined(a, left, b, right):
    form = {i: a * left[0].get(i, 0.0) + b * right[0].get(i, 0.0) for i in {*left[0], *right[0]}}
    return form, a * left[1] + b * right[1]


def standard(file):
    """Columns, costs, constant; rows that are 0, rows >= 0, and rows of second-order cones with the cones' sizes.
    A rotated cone |u|^2 <= 2 s t becomes |(s - t, sqrt2 u)| <= s + t."""
    n, costs, constant, cones, rows = read(file)
    equal, linear, second, sizes, at = [], [], [], [], 0
    for kind, size in cones:
        part = rows[at:at + size]
        at += size
        if kind == "L=":
            equal += part
        elif kind == "L+":
            linear += part
        else:
            assert kind == "QR"
            second += [combined(1, part[0], 1, part[1]), combined(1, part[0], -1, part[1])]
            second += [combined(2**0.5, u, 0, u) for u in part[2:]]
            sizes.append(size)
    return n, [costs.get(i, 0.0) for i in range(n)], constant, equal, linear, second, sizes


def solve(file):
    """Status, objective and point."""
    from cvxopt import matrix, solvers, spmatrix  # here, so that others may read files without it
    n, costs, constant, equal, linear, second, sizes = standard(file)

    def system(forms):
        places = [(r, i, v) for r, (form, _) in enumerate(forms) for i, v in form.items()]
        a = spmatrix([v for _, _, v in places], [r for r, _, _ in places], [i for _, i, _ in places], (len(forms), n))
        return a, matrix([value for _, value in forms], (len(forms), 1), "d")

    g, h = system(linear + second)
    a, b = system(equal)
    c = matrix(costs, (n, 1), "d")
    solvers.options["show_progress"] = False
    answer = {"status": "unknown"}
    for tolerance in (1e-9, 1e-8, 1e-7):  # its steps break down now and then
        solvers.options.update(abstol=tolerance, reltol=tolerance, feastol=tolerance)
        try:
            answer = solvers.conelp(c, -g, h, {"l": len(linear), "q": sizes, "s": []}, a, -b)
        except (ArithmeticError, ValueError):
            continue
        if answer["status"] != "unknown":
            break
    if answer["status"] != "optimal":
        return answer["status"], None, []
    return "optimal", answer["primal objective"] + constant, list(answer["x"])


if __name__ == "__main__":
    status, _, x = solve(sys.argv[1])
    claim = {"optimal": "solved", "primal infeasible": "infeasible", "dual infeasible": "unbounded"}
    with open(sys.argv[2], "w", encoding="ascii") as out:
        print(claim.get(status, "failed"), *x, sep="\n", file=out)
