#!/usr/bin/env python3
"""Solves a mixed-integer program for `accdec compare`: highs_solver.py PROBLEM.mps ANSWER SECONDS, with the HiGHS in
Debian's python3-scipy.

This is an example of an [[external]] solver with `reads = "mps"` and `answer = "values"`: see rivals.toml.
"""
import sys

import numpy
from scipy.optimize import Bounds, LinearConstraint, milp
from scipy.sparse import coo_matrix


def read(file):
    """Costs, rows, bounds and whole variables of a free MPS file as accdec writes it."""
    kinds, entries, costs, right, widths, low, high, whole = {}, [], {}, {}, {}, {}, {}, set()
    columns, section, in_whole = {}, "", False
    with open(file, encoding="ascii") as text:
        for line in text:
            words = line.split()
            if line[0] != " ":
                section = words[0]
            elif section == "ROWS" and words[1] != "COST":
                kinds[words[1]] = (len(kinds), words[0])
            elif section == "COLUMNS" and words[1] == "'MARKER'":
                in_whole = words[2] == "'INTORG'"
            elif section == "COLUMNS":
                i = columns.setdefault(words[0], len(columns))
                whole |= {i} if in_whole else set()
                if words[1] == "COST":
                    costs[i] = float(words[2])
                else:
                    entries.append((kinds[words[1]][0], i, float(words[2])))
            elif section in ("RHS", "RANGES"):
                (right if section == "RHS" else widths)[words[1]] = float(words[2])
            elif section == "BOUNDS":
                i, value = columns[words[2]], float(words[3]) if len(words) > 3 else 0.0
                if words[0] in ("FX", "LO"):
                    low[i] = value
                if words[0] in ("FX", "UP"):
                    high[i] = value
                if words[0] in ("FR", "MI"):
                    low[i] = -numpy.inf
    n, m = len(columns), len(kinds)
    least, most = numpy.full(m, -numpy.inf), numpy.full(m, numpy.inf)
    for name, (r, kind) in kinds.items():
        side = right.get(name, 0.0)
        if kind in "EL":
            most[r] = side
        if kind in "EG":
            least[r] = side
        if name in widths:
            least[r] = side - widths[name]
    rows, places, values = zip(*entries)
    return ([costs.get(i, 0.0) for i in range(n)],
            LinearConstraint(coo_matrix((values, (rows, places)), (m, n)).tocsr(), least, most),
            Bounds([low.get(i, 0.0) for i in range(n)], [high.get(i, numpy.inf) for i in range(n)]),
            [int(i in whole) for i in range(n)])


def solve(file, seconds):
    costs, rows, bounds, whole = read(file)
    return milp(costs, integrality=whole, bounds=bounds, constraints=rows,
                options={"time_limit": float(seconds), "mip_rel_gap": 0.0})


def main():
    file, answer, seconds = sys.argv[1:]
    found = solve(file, seconds)
    claim = {0: "solved", 1: "time limit", 2: "infeasible", 3: "unbounded"}.get(found.status, "failed")
    with open(answer, "w", encoding="ascii") as out:
        print(claim, *([] if found.x is None else map(float, found.x)), sep="\n", file=out)


if __name__ == "__main__":
    main()
