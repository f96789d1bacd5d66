"""Whole programs."""

from __future__ import annotations

import os
from typing import Optional, Union

from . import _arguments as arguments
from . import _core
from ._core import ProfileProgram, Program
from ._design import Progress, TaskLike
from ._fields import as_task


_FLAGS = ("rapid_stops", "dwells_before_filter", "filter_bound", "compensate_arcs")


def program(file: Union[str, "os.PathLike[str]"], task: TaskLike, *, plan: str = "fixed", feeds: str = "choose",
            arc_tolerance: Optional[float] = None, time_limit: Optional[float] = None, rapid_stops: bool = False,
            dwells_before_filter: bool = False, filter_bound: bool = False, compensate_arcs: bool = False,
            tool_table: Union[str, "os.PathLike[str]"] = "", progress: Progress = None
            ) -> Union[Program, ProfileProgram]:
    """Plan a whole program: filter, feeds and the delay of every corner, verified by simulating every sample.

    Parameters
    ----------
    file : path
        RS-274, canonical calls (rs274 -g) or CSV of points and feeds.
    task : Task, path or dict
        Sample period, axes, [program] error_max and, if given, the filter; else one is designed.
    plan : {"fixed", "per-leg", "profiles"}
        One filter for the whole program; its shape in the length that suits each leg, where that is faster; or every
        corner its own filter and speed, for controllers that take a position every cycle: the others are made beside
        it, and the fastest that holds all limits is the answer.
    feeds : {"choose", "keep"}
        F is an upper bound, or every block at its programmed feed.
    arc_tolerance : float, optional
        m, largest distance of a chord from its arc; by default that of the command line.
    time_limit : float, optional
        s, for the design of a filter; by default 2 s and 5 ms a block, at most 60.
    rapid_stops, dwells_before_filter, filter_bound : bool
        As of the command line.
    compensate_arcs : bool
        Command arcs on a radius larger by what the filter takes away; not with ``feeds="keep"``.
    tool_table : path, optional
        LinuxCNC's, for programs that rs274 has to run.
    progress : bool or callable, optional

    Returns
    -------
    Program or ProfileProgram
        The latter with ``plan="profiles"`` where that is the fastest plan. Its `plan` says which it is.

    Examples
    --------
    >>> import accdec, pathlib, tempfile
    >>> square = pathlib.Path(tempfile.mkdtemp()) / "square.ngc"
    >>> _ = square.write_text("G21 G90 G64 P0.05\\nG1 X20 F3000\\nY20\\nX0\\nY0\\nM2\\n")
    >>> plan = accdec.program(square, {"sample_period": 1e-3, "axes": {"acceleration_max": 5.0}})
    >>> plan.success, len(plan.delays) >= 4, bool((plan.errors <= plan.tolerances * (1 + 1e-9)).all())
    (True, True, True)
    >>> faster = accdec.program(square, {"sample_period": 1e-3, "axes": {"acceleration_max": 5.0}}, plan="profiles")
    >>> faster.plan, faster.cycle_time < plan.cycle_time, [other["plan"] for other in faster.candidates]
    ('profiles', True, ['per-leg'])
    """
    arguments.one_of("plan", plan, ("fixed", "per-leg", "profiles"))
    keep = arguments.one_of("feeds", feeds, ("choose", "keep")) == "keep"
    given = locals()
    flags = {name: arguments.flag(name, given[name]) for name in _FLAGS}
    if compensate_arcs and keep:
        raise ValueError('compensate_arcs needs feeds="choose"')
    if arc_tolerance is not None:
        arguments.number("arc_tolerance", arc_tolerance, "allowed is 1e-9 to 1e-2 (m)", 1e-9, 1e-2)
    if time_limit is not None:
        arguments.seconds("time_limit", time_limit)
    return _core.program(arguments.path("file", file), as_task(task, program=True), plan=plan, keep_feeds=keep,
                         arc_tolerance=arc_tolerance, time_limit=time_limit, **flags,
                         tool_table=arguments.path("tool_table", tool_table), progress=arguments.listener(progress))
