"""Why a design is as long as it is, and what the filters of controllers do at the same limits."""

from __future__ import annotations

from typing import Any

from . import _arguments as arguments
from . import _core
from ._core import Explanation
from ._design import Progress, TaskLike
from ._fields import as_task


def explain(task: TaskLike, *, by: float = 0.1, time_limit: float = 300.0, design_time_limit: float = 10.0,
            progress: Progress = None) -> Explanation:
    """Say which limits bind where, and what more room for each saves or makes possible.

    The task is designed again with more room for every limit. For a task without a design, the smallest change of each
    limit is found that makes it feasible. Designs are verified by simulation, bounds rechecked.

    Parameters
    ----------
    task : Task, path or dict
    by : float
        How much more room to try, a share of every limit, 0 < by < 1.
    time_limit, design_time_limit : float
        s. The first is for all designs: then the answers so far are returned, and `complete` is False. The second is
        for each design, in processor time. If nothing can be proved, as of servos that differ, all designs share it.
    progress : bool or callable, optional

    Returns
    -------
    Explanation
        `print` shows it in sentences; `bindings`, `gains`, `remedies` are lists of dict.

    Examples
    --------
    >>> import accdec
    >>> task = accdec.Task(sample_period=1e-3, axes={"acceleration_max": 6.0, "jerk_max": 500.0},
    ...                    corners={"angle_deg": 95, "feed_in": 0.1, "error_max": 50e-6})
    >>> best = accdec.explain(task).gains[0]
    >>> best["proved"], round(1e3 * best["gain_s"], 6)  # ms; nothing saves more
    (True, 2.0)
    >>> remedies = accdec.explain(task.replace(order_max=15)).remedies  # of a task that has no design
    >>> remedies[0]["helps"], [r["levers"][0]["enough"] for r in remedies if r["key"] == "design.order_max"]
    ('yes', [27.0])
    """
    return _core.explain(
        as_task(task), share=arguments.number("by", by, "must be above 0 and below 1", 1e-9, 1.0 - 1e-9),
        time_limit=arguments.seconds("time_limit", time_limit),
        design_time_limit=arguments.seconds("design_time_limit", design_time_limit),
        progress=arguments.listener(progress))


def baselines(task: TaskLike, *, finer: int = 1, time_limit: float = 600.0, progress: Progress = None) -> Any:
    """Compare the design of a task with the best filters of controllers under the same limits.

    Parameters
    ----------
    task : Task, path or dict
        Its `baseline`, or else its filter, is shown as "yours". The designs ignore it.
    finer : int
        Divides the sample period by this. If a saving becomes smaller, the difference was rounding to whole samples.
    time_limit : float
        s, for the design.
    progress : bool or callable, optional

    Returns
    -------
    pandas.DataFrame
        One row per filter: "designed", "yours" if there is one, then every family with its best order and parameters:
        kind, parameters, order, delays, cycle_time and corner_time (s), more (share of the design's time), exact_stop
        (no legs overlap), outcome, message. ``attrs["saving"]`` is the share of the best family's time that the design
        saves (None without both), ``attrs["results"]`` has the `Result` of every row.

    Examples
    --------
    >>> import accdec
    >>> task = accdec.Task(sample_period=1e-3, axes={"acceleration_max": 6.0, "jerk_max": 500.0},
    ...                    corners={"angle_deg": 95, "feed_in": 0.1, "error_max": 50e-6})
    >>> table = accdec.baselines(task)
    >>> bool((table["more"].dropna() >= 0.0).all()), 0.0 <= table.attrs["saving"] < 1.0
    (True, True)
    """
    import pandas
    rows = _core.baselines(as_task(task), finer=arguments.whole("finer", finer, 1, 1000),
                           time_limit=arguments.seconds("time_limit", time_limit),
                           progress=arguments.listener(progress))
    results = [row.pop("result") for row in rows]
    best = results[0].fun
    for row, result in zip(rows, results):
        found = result.success
        row.update(order=result.order, delays=result.delays.tolist() if found else None, cycle_time=result.cycle_time,
                   corner_time=result.corner_time, more=result.fun / best - 1.0 if found and best else None,
                   outcome=result.outcome, message=result.message)
    table = pandas.DataFrame(rows)
    families = [result.fun for row, result in zip(rows, results)
                if row["filter"] not in ("designed", "yours") and result.success]
    table.attrs["saving"] = 1.0 - best / min(families) if best and families else None
    table.attrs["results"] = {row["filter"]: result for row, result in zip(rows, results)}
    return table
