"""Designing, evaluating and verifying."""

from __future__ import annotations

import os
from typing import Any, Callable, Mapping, Optional, Sequence, Union

import numpy.typing as npt

from . import _arguments as arguments
from . import _core
from ._core import Recheck, Result, Task
from ._fields import as_task

TaskLike = Union[Task, str, "os.PathLike[str]", Mapping[str, Any]]
Progress = Union[bool, Callable[[str], object], None]


def _by_solver(method: Optional[str], solver: Optional[str], gap: float) -> bool:
    """Whether a nonlinear solver is asked for; what goes with no such thing is refused."""
    arguments.number("gap", gap, "must be from 0 to less than 1", 0.0, 1.0 - 1e-16)
    if method is not None:
        arguments.one_of("method", method, ("exact", "nlp"))
    if solver is not None and method == "exact":
        raise ValueError('method="exact" and solver exclude each other: a solver is used by method="nlp"')
    nlp = method == "nlp" or solver is not None
    if gap > 0.0 and nlp:
        raise ValueError("gap goes with the exact method: no other proves a bound")
    return nlp


def _start(start: Optional[npt.ArrayLike], task: Task, nlp: bool, solver: str) -> Optional[list[float]]:
    """Taps that a nonlinear solver starts from, refused where nothing would use them."""
    if start is None:
        return None
    if not nlp or task.taps is not None:
        raise ValueError("start: the filter is given, so its delays are enumerated" if task.taps is not None else
                         "start goes with solver: the exact method takes none")
    taps = arguments.vector("start", start)
    if not task.order_min <= len(taps) - 1 <= task.order_max:
        raise ValueError(f"start: its order is {len(taps) - 1}, the task allows {task.order_min} to {task.order_max}")
    searches_a_box = [s["name"] for s in _core.solvers() if s["is_global"]]
    if solver in searches_a_box:
        raise ValueError(f'start: "{solver}" searches all of its box, wherever it starts')
    return taps.tolist()


def _options(task: Task, given: Optional[Mapping[str, Any]], nlp: bool) -> dict[str, str]:
    native = arguments.native(given)
    if native and (not nlp or task.taps is not None):
        raise ValueError("options: the filter is given, so its delays are enumerated and no solver is used"
                         if task.taps is not None else "options go with solver: the exact method takes none")
    return native


def _with_corners(task: TaskLike, objective: Optional[str]) -> Task:
    made = as_task(task)
    if not made.corners:
        raise _core.InputError("task: the task has no corner; at least one corner with angle_deg and feed_in_mm_min "
                               "is needed")
    return made if objective is None else made.replace(objective=arguments.text("objective", objective))


def design(task: TaskLike, *, method: Optional[str] = None, solver: Optional[str] = None, time_limit: float = 600.0,
           gap: float = 0.0, objective: Optional[str] = None, seed: int = 1, threads: Optional[int] = None,
           options: Optional[Mapping[str, Any]] = None, certificate: bool = True, reduced: Optional[bool] = None,
           start: Optional[npt.ArrayLike] = None, progress: Progress = None) -> Result:
    """Choose what a task leaves open: the filter, its order and the corners' delays.

    The answer is verified by simulation; nothing that breaks a limit is a result. Ctrl-C ends the search.

    Parameters
    ----------
    task : Task, path or dict
    method : {"exact", "nlp"}, optional
        "exact" (default) proves the shortest motion; "nlp" uses a nonlinear solver and proves nothing.
    solver : str, optional
        Nonlinear solver, see `solvers`; implies ``method="nlp"``. Default "ipopt".
    time_limit : float
        s, for the whole design; then the answer is the best verified design so far.
    gap : float
        End once the design is proved to be this close to the shortest time, 0 <= gap < 1. Exact method only.
    objective : {"cycle", "corner"}, optional
        Instead of the task's. "cycle" is machine time, "corner" counts the filter at every corner.
    seed : int
        Seed of solvers that draw random numbers.
    threads : int, optional
        Threads for proofs of several corners, by default one per core. Design and proof do not depend on it.
    options : dict, optional
        The solver's own options.
    certificate : bool
        Keep the proof in the result, for `verify`.
    reduced : bool, optional
        Nonlinear solvers: substitute positions into their bounds; the default is the form the solver takes.
    start : array_like, optional
        Local nonlinear solvers: taps to start from, at their order. Other orders start from a trapezoid.
    progress : bool or callable, optional
        True prints one line per step; a callable gets the line, in the calling thread.

    Returns
    -------
    Result
        As SciPy's OptimizeResult: `x` (taps), `fun` (s), `mip_dual_bound` (s, proved), `delays`, `limits`...

    Examples
    --------
    >>> import accdec
    >>> task = accdec.Task(sample_period=1e-3, axes={"acceleration_max": 6.0},
    ...                    corners={"angle_deg": 95, "feed_in": 0.1, "error_max": 50e-6})
    >>> result = accdec.design(task)
    >>> result.success, round(result.fun, 6), result.order, result.delays.tolist()  # s, N, samples
    (True, 0.027, 16, [10])
    """
    made = _with_corners(task, objective)
    nlp = _by_solver(method, solver, gap)
    chosen = arguments.text("solver", solver or "ipopt")
    return _core.design(
        made, method="nlp" if nlp else "exact", solver=chosen, gap=float(gap), seed=arguments.seed(seed),
        time_limit=arguments.seconds("time_limit", time_limit), native=_options(made, options, nlp),
        threads=arguments.whole("threads", os.cpu_count() or 1 if threads is None else threads, 1, 1024),
        certificate=arguments.flag("certificate", certificate), start=_start(start, made, nlp, chosen),
        reduced=reduced if reduced is None else arguments.flag("reduced", reduced),
        progress=arguments.listener(progress))


def evaluate(task: TaskLike, taps: Optional[npt.ArrayLike] = None,
             delays: Optional[Sequence[int]] = None) -> Result:
    """Errors, times and use of limits of a given filter and given delays, even if they break limits.

    Parameters
    ----------
    task : Task, path or dict
    taps : array_like, optional
        b_0 .. b_N, of any sum. The default is the task's filter.
    delays : sequence of int, optional
        Samples, one per corner. The default is the task's delays.

    Returns
    -------
    Result
        `success` says whether all limits hold; the filter stays in the result either way.

    Examples
    --------
    >>> import accdec, numpy as np
    >>> task = accdec.Task(sample_period=1e-3, corners={"angle_deg": 90, "feed_in": 0.1})
    >>> result = accdec.evaluate(task, taps=np.ones(3), delays=[0])
    >>> round(result.corners[0]["corner_error"] * 1e6, 3)  # um; three equal taps: 2/3 v T cos(45 deg)
    47.14
    """
    given = taps is None and delays is None
    made = as_task(task, complete=given)
    if taps is None:
        taps = made.taps
        if taps is None:
            raise ValueError("taps: the task has no filter, so the taps are needed")
    if delays is None:
        delays = [corner["delay"] for corner in made.corners]
        if None in delays:
            raise ValueError("delays: the task leaves a delay open, so the delays are needed")
    if given:
        return _core.evaluate(made)
    return _core.assess(made, arguments.vector("taps", taps).tolist(), arguments.delays(delays, len(made.corners)))


def read_result(path: Union[str, "os.PathLike[str]"]) -> Result:
    """Read a result file, as `design` of the command line writes with --json.

    Parameters
    ----------
    path : path
        A file of the schema accdec.result/1.

    Returns
    -------
    Result
        As recorded; `verify` recomputes it.

    Examples
    --------
    >>> import accdec, pathlib, tempfile
    >>> path = pathlib.Path(tempfile.mkdtemp()) / "result.json"
    >>> accdec.design({"sample_period": 1e-3, "corners": {"angle_deg": 90, "feed_in": 0.1}}).write(path)
    >>> accdec.read_result(path).outcome
    'optimal'
    """
    return _core.Result.read(arguments.path("path", path))


def verify(result: Union[Result, str, "os.PathLike[str]"], *, time_limit: float = 60.0) -> Recheck:
    """Recheck a result from its task, taps and delays alone.

    It checks every limit by simulation, every recorded number by computing it again, and the proof in interval
    arithmetic.

    Parameters
    ----------
    result : Result or path
    time_limit : float
        s, for checking a proof; one that takes longer is rejected.

    Returns
    -------
    Recheck
        True if accepted; `reasons` says why not, `proof` what was proved.

    Examples
    --------
    >>> import accdec
    >>> task = accdec.Task(sample_period=1e-3, axes={"acceleration_max": 6.0},
    ...                    corners={"angle_deg": 95, "feed_in": 0.1, "error_max": 50e-6})
    >>> bool(accdec.verify(accdec.design(task)))
    True
    """
    if not isinstance(result, (Result, str, os.PathLike)):
        raise arguments.wrong("result", "must be a Result or the path of a result file", result, TypeError)
    return _core.verify(result if isinstance(result, Result) else read_result(result),
                        time_limit=arguments.seconds("time_limit", time_limit))
