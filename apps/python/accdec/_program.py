"""Whole programs."""

from __future__ import annotations

import os
from typing import Mapping, Optional, Sequence, Union

from . import _arguments as arguments
from . import _core
from ._core import Program
from ._design import Progress, TaskLike
from ._fields import as_task


_FLAGS = ("rapid_stops", "dwells_before_filter", "filter_bound", "compensate_arcs")


def program(file: Union[str, "os.PathLike[str]"], task: TaskLike, *, plan: str = "fixed", feeds: str = "choose",
            arc_tolerance: Optional[float] = None, time_limit: Optional[float] = None, rapid_stops: bool = False,
            dwells_before_filter: bool = False, filter_bound: bool = False, compensate_arcs: bool = False,
            tool_table: Union[str, "os.PathLike[str]"] = "", tool_length: Optional[float] = None,
            estimate: Sequence[str] = (), estimate_options: Optional[Mapping[str, float]] = None,
            progress: Progress = None) -> Program:
    """Plan a whole program: choose filter, feeds and the delay of every corner, and verify every sample by simulation.

    Parameters
    ----------
    file : path
        RS-274, canonical calls (rs274 -g) or CSV of points and feeds.
    task : Task, path or dict
        Sample period, axes, [program] error_max and the filter. Without a filter, one is designed.
    plan : {"fixed", "profiles", "free"}
        "fixed": one filter for the whole program. "profiles": a filter and a speed for every corner, for controllers
        that take a position every cycle. "profiles" also makes the plan "fixed", and motions along the
        arcs, whose plan is "free". It returns the fastest one that keeps all limits. "free": the fastest one,
        shortened by convex programs over its samples as far as limits, feeds and tolerances allow. See the page of the
        command line.
    feeds : {"choose", "keep"}
        "choose": F is an upper bound. "keep": every block has its programmed feed; only with plan "fixed".
    arc_tolerance : float, optional
        m, largest distance of a chord from its arc. The default is that of the command line.
    time_limit : float, optional
        s, for all; the design of a filter gets half of it. By default the design gets 2 s plus 5 ms per block, at most
        60 s, and planning takes as long as it needs.
    rapid_stops, dwells_before_filter, filter_bound, compensate_arcs : bool
        As on the command line. The last one compensates the filter's radius error of arcs; not with "keep".
    tool_table : path, optional
        LinuxCNC's tool table, for programs that rs274 must run.
    tool_length : float, optional
        m, length of every tool for G43, in place of a table; 0 if the program's Z is always that of the tool's tip.
    estimate : sequence of {"klipper", "grbl", "linuxcnc-2.9"}
        Other controls whose time is estimated, by the rules of their planners; see `Program.estimates`.
    estimate_options : dict, optional
        Parameters of these controls by their own names, in their own units: ``{"square_corner_velocity": 8}``, mm/s.
    progress : bool or callable, optional

    Returns
    -------
    Program
        Its `plan` names the plan.

    Examples
    --------
    >>> import accdec, pathlib, tempfile
    >>> square = pathlib.Path(tempfile.mkdtemp()) / "square.ngc"
    >>> _ = square.write_text("G21 G90 G64 P0.05\\nG1 X20 F3000\\nY20\\nX0\\nY0\\nM2\\n")
    >>> plan = accdec.program(square, {"sample_period": 1e-3, "axes": {"acceleration_max": 5.0}})
    >>> plan.success, len(plan.delays) >= 4, bool((plan.errors <= plan.tolerances * (1 + 1e-9)).all())
    (True, True, True)
    >>> part = {"sample_period": 1e-3, "axes": {"velocity_max": 0.2, "acceleration_max": 1.0}}
    >>> options = {"junction_deviation": 0.02}
    >>> [grbl] = accdec.program(square, part, estimate=["grbl"], estimate_options=options).estimates
    >>> grbl["control"], 1.6 < grbl["time"] < 2.0, grbl["parameters"]["junction_deviation"]
    ('grbl', True, 0.02)
    >>> faster = accdec.program(square, {"sample_period": 1e-3, "axes": {"acceleration_max": 5.0}}, plan="profiles")
    >>> faster.plan, faster.cycle_time <= plan.cycle_time, [other["plan"] for other in faster.candidates]
    ('profiles', True, ['fixed'])
    """
    controls = [estimate] if isinstance(estimate, str) else estimate
    if not isinstance(controls, (list, tuple)):
        raise arguments.wrong("estimate", "must be a list of controls", estimate, TypeError)
    for control in controls:
        arguments.one_of("estimate", control, _core.estimated_controls())
    if not isinstance(estimate_options, (Mapping, type(None))):
        raise arguments.wrong("estimate_options", "must be a dict of numbers", estimate_options, TypeError)
    options = {str(name): arguments.real(f"estimate_options[{name!r}]", value)
               for name, value in (estimate_options or {}).items()}
    if options and not controls:
        raise ValueError("estimate_options needs estimate")
    if controls and dwells_before_filter:
        raise ValueError("estimate excludes dwells_before_filter: other controls stop for G4")
    arguments.one_of("plan", plan, _core.plan_names())
    keep = arguments.one_of("feeds", feeds, ("choose", "keep")) == "keep"
    given = locals()
    flags = {name: arguments.flag(name, given[name]) for name in _FLAGS}
    if compensate_arcs and keep:
        raise ValueError('compensate_arcs needs feeds="choose"')
    if arc_tolerance is not None:
        arguments.number("arc_tolerance", arc_tolerance, "allowed is 1e-9 to 1e-2 (m)", 1e-9, 1e-2)
    if time_limit is not None:
        arguments.seconds("time_limit", time_limit)
    if tool_length is not None:
        arguments.number("tool_length", tool_length, "allowed is -1000 to 1000 (m)", -1e3, 1e3)
        if os.fspath(tool_table):
            raise ValueError("tool_length and tool_table exclude each other")
    return _core.program(arguments.path("file", file), as_task(task, program=True), plan=plan, keep_feeds=keep,
                         arc_tolerance=arc_tolerance, time_limit=time_limit, **flags,
                         tool_table=arguments.path("tool_table", tool_table), tool_length=tool_length,
                         estimate=list(controls), estimate_options=options, progress=arguments.listener(progress))
