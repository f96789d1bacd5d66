"""Figures, drawn by the library as the program draws them; and taps for controllers."""

from __future__ import annotations

import os
from functools import partial
from typing import Callable, Optional, Union

from . import _arguments as arguments
from . import _core
from ._core import Program, Result


class Figure:
    """A drawing, made by `plot`. Notebooks show it.

    Attributes
    ----------
    svg : str
        The drawing as SVG.
    """

    def __init__(self, draw: Callable[[str], bytes]) -> None:
        self._draw = draw
        self.svg = draw("svg").decode()

    def __repr__(self) -> str:
        return f"<accdec.Figure, {len(self.svg) / 1e3:.0f} kB of SVG>"

    def _repr_svg_(self) -> str:
        return self.svg

    def savefig(self, path: Union[str, "os.PathLike[str]"]) -> None:
        """Write the drawing as .svg, .png, .pdf or .html: a page with the tables of the result, or to zoom into."""
        file = arguments.path("path", path)
        format = _core.figure_format(file)
        _core.write_file(file, self.svg.encode() if format == "svg" else self._draw(format))


def plot(result: Union[Result, Program], corner: str = "",
         path: Optional[Union[str, "os.PathLike[str]"]] = None) -> Figure:
    """Draw the motion, path, taps and frequency response of a result, or the path and speed of a program.

    It needs gnuplot, and rsvg-convert for .png and .pdf (Debian packages gnuplot-nox and librsvg2-bin).

    Parameters
    ----------
    result : Result or Program
        A program is drawn with corner errors, speeds and the time that its corners cost.
    corner : str
        Name of the result's corner to draw. The default is the first.
    path : path, optional
        File to write: .svg, .png, .pdf or .html.

    Returns
    -------
    Figure
        The figure of `accdec plot`, or for a program of `accdec program --figure`.

    Examples
    --------
    >>> import accdec
    >>> task = accdec.Task(sample_period=1e-3, axes={"acceleration_max": 6.0},
    ...                    corners={"angle_deg": 95, "feed_in": 0.1, "error_max": 50e-6})
    >>> figure = accdec.plot(accdec.design(task))
    >>> "path around corner" in figure.svg
    True
    """
    if isinstance(result, Program):
        made = Figure(partial(_core.program_drawing, result))
    elif isinstance(result, Result):
        made = Figure(partial(_core.result_drawing, result, arguments.text("corner", corner)))
    else:
        raise arguments.wrong("result", "must be a Result or a Program", result, TypeError)
    if path is not None:
        made.savefig(path)
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
