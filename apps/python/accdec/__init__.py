"""Design the acceleration/deceleration filter of CNC motion commands, and the command delay of every corner.

>>> import accdec
>>> task = accdec.Task(sample_period=1e-3, axes={"acceleration_max": 6.0, "jerk_max": 500.0},
...                    corners={"angle_deg": 95, "feed_in": 0.1, "error_max": 50e-6})
>>> result = accdec.design(task)
>>> result.outcome, result.mip_gap  # proved: nothing is shorter
('optimal', 0.0)
>>> round(1e3 * result.fun, 6)  # ms around the corner
42.0

Keyword arguments and results are in SI units (m, s, kg, N, W, rad). If a name ends in a unit (`angle_deg`,
`feed_in_mm_min`), as in task files, it is in that unit.
"""

from . import _notebook
from ._core import (Explanation, InputError, OutputError, Program, Recheck, Result, StopRun, Task,
                    __version__)
from ._design import design, evaluate, read_result, verify
from ._explain import baselines, explain
from ._identify import identify
from ._motion import residual_vibration, simulate, smallest_delay, taps
from ._nlp import Problem, problem, register_solver, solve, solvers
from ._plot import Figure, export, plot
from ._program import program
from ._sliders import sliders
from ._study import compare, study

del _notebook  # it has given the classes what notebooks ask for

__all__ = [
    "Explanation", "Figure", "InputError", "OutputError", "Problem", "Program", "Recheck", "Result",
    "StopRun", "Task", "__version__", "baselines", "compare", "design", "evaluate", "explain", "export",
    "identify", "plot", "problem", "program", "read_result", "register_solver", "residual_vibration", "simulate",
    "sliders", "smallest_delay", "solve", "solvers", "study", "taps", "verify",
]
