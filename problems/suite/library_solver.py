#!/usr/bin/env python3
"""Solves a cone program for `accdec compare` with a cone solver that is a Python module and not in Debian 12:
library_solver.py scs|clarabel PROBLEM.cbf ANSWER SECONDS. See external.toml.

`pip install scs` or `pip install clarabel` brings them; both need python3-scipy.
"""
import sys

import numpy
from scipy.sparse import csc_matrix
from cone_solver import standard

CLAIMS = {"solved": "solved", "infeasible": "infeasible", "primalinfeasible": "infeasible", "unbounded": "unbounded",
          "dualinfeasible": "unbounded"}


def scs(c, a, b, zeros, linear, sizes, seconds):
    import scs as module
    solver = module.SCS({"A": a, "b": b, "c": c}, {"z": zeros, "l": linear, "q": sizes}, verbose=False, eps_abs=1e-9,
                        eps_rel=1e-9, max_iters=10**7, time_limit_secs=seconds)
    answer = solver.solve()
    return answer["info"]["status"], answer["x"]


def clarabel(c, a, b, zeros, linear, sizes, seconds):
    import clarabel as module
    settings = module.DefaultSettings()
    settings.verbose, settings.time_limit = False, seconds
    cones = [module.ZeroConeT(zeros), module.NonnegativeConeT(linear), *map(module.SecondOrderConeT, sizes)]
    nothing = csc_matrix((len(c), len(c)))
    answer = module.DefaultSolver(nothing, c, a, b, cones, settings).solve()
    return str(answer.status), numpy.array(answer.x)


def main():
    name, problem, result, seconds = sys.argv[1:]
    n, costs, _, equal, linear, second, sizes = standard(problem)
    rows = equal + linear + second  # in the order of the cones: every row's form and constant is the slack b - a x
    places = [(r, i, -value) for r, (form, _) in enumerate(rows) for i, value in form.items()]
    a = csc_matrix(([p[2] for p in places], ([p[0] for p in places], [p[1] for p in places])), (len(rows), n))
    b = numpy.array([constant for _, constant in rows])
    solve = {"scs": scs, "clarabel": clarabel}[name]
    status, x = solve(numpy.array(costs), a, b, len(equal), len(linear), sizes, float(seconds))
    with open(result, "w", encoding="ascii") as out:
        print(CLAIMS.get(status.lower(), "failed"), *x, sep="\n", file=out)


if __name__ == "__main__":
    main()
