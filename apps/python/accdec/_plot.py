"""Figures as the program draws them, by matplotlib; and taps for controllers."""

from __future__ import annotations

import os
import re
from ast import literal_eval
from typing import Any, Optional, Union

import numpy as np

from . import _arguments as arguments
from . import _core
from ._core import Program, Result

PX = 1 / 100  # inch: figures are laid out in px
_SYMBOLS = {1: "+", 2: "x", 3: "*", 4: "s", 5: "s", 6: "o", 7: "o", 8: "^", 9: "^", 10: "v", 11: "v", 12: "D", 13: "D",
            14: "p", 15: "p"}
_OPEN = (4, 6, 8, 10, 12, 14)


class _Style:
    """The looks of the program's figures, in matplotlib's words."""

    def __init__(self) -> None:
        self.raw = _core.figure_style()

    def line(self, style: int, solid: bool = False) -> dict[str, Any]:
        raw, i = self.raw, max(style, 0)
        dash = "solid" if solid else raw["dashes"][i % len(raw["dashes"])]
        width = float(raw["widths"][i // len(raw["dashes"]) % len(raw["widths"])])
        # matplotlib multiplies dashes by the line's width.
        return {"color": self.colour(style), "linewidth": 0.72 * width,
                "linestyle": "-" if dash == "solid" else (0, tuple(n / width for n in literal_eval(dash)))}

    def colour(self, style: int) -> str:
        return str(self.raw["colours"][max(style, 0) % len(self.raw["colours"])])

    def marker(self, style: int) -> dict[str, Any]:
        symbol = self.raw["points"][max(style, 0) % len(self.raw["points"])]
        colour = self.colour(style)
        return {"marker": _SYMBOLS[symbol], "markersize": 3.2, "markeredgecolor": colour,
                "markerfacecolor": "none" if symbol in _OPEN else colour}

    def palette(self, name: str) -> Any:
        from matplotlib.colors import LinearSegmentedColormap
        stops = [(float(at), colour) for at, colour in re.findall(r"(-?[\d.]+) '(#\w+)'", self.raw[name])]
        low, high = stops[0][0], stops[-1][0]
        return LinearSegmentedColormap.from_list(f"accdec-{name}", [((s - low) / (high - low), c) for s, c in stops])


def _draw_series(axes: Any, series: dict[str, Any], style: _Style) -> None:
    x, y, mark = series["x"], series["y"], series["mark"]
    if len(x) == 0:
        return
    look = {"label": series["label"] or None, "color": style.colour(series["style"])}
    line = {**look, **style.line(series["style"], series.get("solid", False))}
    marks = {**style.marker(series["style"])}
    if mark == "points":
        axes.plot(x, y, **look, **marks, linestyle="none")
    elif mark == "line_points":
        axes.plot(x, y, **line, **marks)
    elif mark == "steps":
        axes.plot(x, y, **line, drawstyle="steps-pre")
    elif mark == "impulses":
        axes.vlines(x, 0.0, y, colors=look["color"], label=look["label"], linewidth=1.1)
    elif mark == "bars":
        apart = np.diff(np.sort(x))
        axes.bar(x, y, width=apart.min() if len(apart) else 1.0, color=look["color"], label=look["label"],
                 edgecolor="white", linewidth=0.5)
    elif mark == "marked_line":
        axes.plot(x, y, **line, **marks, markevery=max(1, len(x) // 6))
    else:
        axes.plot(x, y, **line)


def _draw_heat(axes: Any, heat: dict[str, Any], panel: dict[str, Any], style: _Style) -> None:
    def edges(v: Any, log: bool) -> Any:
        t = np.log(v) if log else np.asarray(v)
        if len(t) == 1:
            t = np.array([t[0] - 0.5, t[0] + 0.5])
        else:
            between = (t[1:] + t[:-1]) / 2
            t = np.concatenate([[2 * t[0] - between[0]], between, [2 * t[-1] - between[-1]]])
        return np.exp(t) if log else t

    values = np.reshape(heat["values"], (len(heat["y"]), len(heat["x"])))
    low, high = np.nanmin(values), np.nanmax(values)
    signed = low < 0.0 < high
    most = max(-low, high)
    mesh = axes.pcolormesh(edges(heat["x"], panel["x"]["log"]), edges(heat["y"], panel["y"]["log"]),
                           np.where(np.isfinite(values), values, np.nan),
                           cmap=style.palette("signed" if signed else "heat"),
                           **({"vmin": -most, "vmax": most} if signed else {}))
    axes.figure.colorbar(mesh, ax=axes, label=heat["label"])


def _draw_coloured(axes: Any, coloured: dict[str, Any], style: _Style) -> None:
    from matplotlib.collections import LineCollection
    pieces = coloured["pieces"]
    lines = LineCollection([np.column_stack([x, y]) for x, y, _ in pieces], cmap=style.palette("lines"),
                           linewidths=0.72 * coloured["line_width"])
    lines.set_array(np.array([value for _, _, value in pieces]))
    lines.set_clim(coloured["low"], coloured["high"])
    axes.add_collection(lines)
    axes.autoscale_view()
    axes.figure.colorbar(lines, ax=axes, label=coloured["label"])


def _draw_panel(axes: Any, panel: dict[str, Any], style: _Style) -> None:
    from matplotlib.patches import Circle
    axes.set_title(panel["title"], fontsize=9)
    for name, scale in (("x", panel["x"]), ("y", panel["y"])):
        getattr(axes, f"set_{name}label")(scale["label"], fontsize=9)
        if scale["log"]:
            getattr(axes, f"set_{name}scale")("log")
    axes.grid(color="#dddddd", linewidth=0.5)
    axes.set_axisbelow(True)
    axes.tick_params(labelsize=8)
    for low, high, label in panel["bands"]:
        axes.axvspan(low, high, color=style.raw["band"], label=label or None, zorder=0)
    if panel["heat_map"]:
        _draw_heat(axes, panel["heat_map"], panel, style)
    if panel["coloured"]:
        _draw_coloured(axes, panel["coloured"], style)
    for series in panel["series"]:
        _draw_series(axes, series, style)
    for y, label in panel["limits"]:
        axes.axhline(y, color=style.raw["limit"], linewidth=0.95, linestyle=(0, (5.4, 3.8)), label=label or None)
    for x, y, radius, label in panel["circles"]:
        axes.add_patch(Circle((x, y), radius, fill=False, color=style.raw["circle"], linewidth=0.95,
                              linestyle=(0, (3, 2.3)), label=label or None))
    for name, scale in (("x", panel["x"]), ("y", panel["y"])):
        getattr(axes, f"set_{name}lim")(scale["min"], scale["max"])
    if panel["equal_aspect"]:
        axes.set_aspect("equal", adjustable="datalim")
    if not panel["has_data"]:
        axes.text(0.5, 0.5, "no data", transform=axes.transAxes, ha="center", color="#606060", fontsize=12)
    if any(label and not label.startswith("_") for label in axes.get_legend_handles_labels()[1]):
        axes.legend(loc="upper left", bbox_to_anchor=(1.01, 1.02), fontsize=8, frameon=False)


def draw(figure: dict[str, Any]) -> Any:
    """A figure of the library as one of matplotlib."""
    from matplotlib import rc_context
    from matplotlib.figure import Figure
    columns, panels = figure["columns"], figure["panels"]
    # Paths keep their shape, and so need taller rows.
    heights = [figure["panel_height"] * (1.6 if any(p["equal_aspect"] for p in panels[i:i + columns]) else 1.0)
               for i in range(0, len(panels), columns)]
    style = _Style()
    with rc_context({"font.family": "DejaVu Sans"}):
        made = Figure(figsize=(figure["panel_width"] * columns * PX, sum(heights) * PX + 0.4), dpi=100,
                      layout="constrained", facecolor="white")
        grid = made.add_gridspec(len(heights), columns, height_ratios=heights)
        made.suptitle(figure["title"], fontsize=11)
        for i, panel in enumerate(panels):
            _draw_panel(made.add_subplot(grid[divmod(i, columns)]), panel, style)
    return made


def _motion_figure(plan: Program) -> dict[str, Any]:
    """The path in the colour of its speed, and the speed over time, from the samples; of long motions every k-th."""
    motion = plan.samples()
    every = max(1, len(motion["time"]) // 20_000)
    time, position, velocity = (motion[name][::every] for name in ("time", "position", "velocity"))
    speed = 1e3 * np.linalg.norm(velocity, axis=1)
    widest = sorted(np.argsort(-np.ptp(position, axis=0), kind="stable")[:2])
    first, second = widest[0], widest[-1]
    x, y = 1e3 * position[:, first], 1e3 * position[:, second]
    panel = {"title": "", "limits": [], "bands": [], "circles": [], "series": [], "heat_map": None, "coloured": None,
             "equal_aspect": False, "has_data": True}

    def scale(label: str) -> dict[str, Any]:
        return {"label": label, "log": False, "min": None, "max": None}

    # Rapid moves would leave one colour for all cutting.
    usual = 1.05 * float(np.quantile(speed, 0.95))
    pieces = [(x[i:i + 2], y[i:i + 2], speed[i + 1]) for i in range(len(x) - 1)]
    coloured = {"pieces": pieces, "low": 0.0, "high": usual if 0.0 < usual < 0.5 * speed.max() else float(speed.max()),
                "line_width": 2.0, "label": "speed / (mm/s)"}
    names = motion["axes"]
    return {"title": f"plan profiles, {plan.cycle_time:.6g} s", "columns": 1, "panel_width": 760, "panel_height": 300,
            "panels": [{**panel, "x": scale(f"{names[first]} / mm"), "y": scale(f"{names[second]} / mm"),
                        "coloured": coloured, "equal_aspect": True},
                       {**panel, "x": scale("time / s"), "y": scale("speed / (mm/s)"),
                        "series": [{"label": "", "x": time, "y": speed, "mark": "line", "style": 0}]}]}


def plot(result: Union[Result, Program], corner: str = "",
         path: Optional[Union[str, "os.PathLike[str]"]] = None) -> Any:
    """Draw the motion, path, taps and frequency response of a result, or the path of a program.

    Parameters
    ----------
    result : Result or Program
        A program is drawn with corner errors and delays; with plan "profiles", with its speed.
    corner : str
        Name of the result's corner to draw. The default is the first.
    path : path, optional
        File to save the figure in, of any format that matplotlib writes.

    Returns
    -------
    matplotlib.figure.Figure
        The figure of `accdec plot`. It is made without pyplot: notebooks show it; in a script, save it.

    Examples
    --------
    >>> import accdec
    >>> task = accdec.Task(sample_period=1e-3, axes={"acceleration_max": 6.0},
    ...                    corners={"angle_deg": 95, "feed_in": 0.1, "error_max": 50e-6})
    >>> figure = accdec.plot(accdec.design(task))
    >>> len(figure.axes) > 4
    True
    """
    if isinstance(result, Program):
        made = draw(_motion_figure(result) if result.plan == "profiles" else _core.program_figure(result))
    elif isinstance(result, Result):
        made = draw(_core.result_figure(result, arguments.text("corner", corner)))
    else:
        raise arguments.wrong("result", "must be a Result or a Program", result, TypeError)
    if path is not None:
        made.savefig(arguments.path("path", path))
    return made


def export(result: Result, format: str, path: Optional[Union[str, "os.PathLike[str]"]] = None) -> Union[str, bytes]:
    """A result's taps or settings, delays, title, limits and commit, for a controller or another tool.

    Parameters
    ----------
    result : Result
    format : {"csv", "c", "json", "npy", "cascade", "m", "st", "linuxcnc-comp", "klipper", "q15", "q31"}
        "cascade": lengths of moving averages; "m": MATLAB and Octave; "st": Structured Text. `numpy.load` of a path
        reads the taps of "npy"; of an open file, three times: taps, delays, and a JSON text with all else.
    path : path, optional
        File to write it to.

    Returns
    -------
    str, or bytes for "npy"
        What is, or would be, in the file.

    Examples
    --------
    >>> import accdec
    >>> task = accdec.Task(sample_period=1e-3, corners={"angle_deg": 90, "feed_in": 0.1})
    >>> print(*accdec.export(accdec.evaluate(task, [1, 2, 1], [0]), "csv").splitlines()[:7], sep="\\n")
    i,b
    0,0.25
    1,0.5
    2,0.25
    # title,
    # status,feasible
    # sample_period_s,0.001
    """
    if not isinstance(result, Result):
        raise arguments.wrong("result", "must be a Result", result, TypeError)
    content = result.export_taps(format)
    if path is not None:
        _core.write_file(arguments.path("path", path), content)
    return content if format == "npy" else content.decode()
