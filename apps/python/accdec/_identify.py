"""The filter that a control or drive has, found in a log of positions."""

from __future__ import annotations

import os
from typing import Any, Mapping, Optional, Union

import numpy as np
import numpy.typing as npt

from . import _arguments as arguments
from . import _core
from ._design import TaskLike
from ._fields import as_task

Log = Union[str, "os.PathLike[str]", Mapping[str, npt.ArrayLike]]


def _positions(log: Mapping[str, npt.ArrayLike]) -> list[list[float]]:
    rows = [arguments.vector(f"log[{arguments.shown(axis)}]", at).tolist() for axis, at in log.items()]
    if not rows:
        raise ValueError("log: must have the positions of at least one axis")
    lengths = sorted({len(row) for row in rows})
    if len(lengths) > 1:
        raise ValueError(f"log: axes must have equally many samples, got {lengths[0]} and {lengths[-1]}")
    return rows


def identify(log: Log, task: TaskLike, *, noise: Optional[float] = None,
             feed: Optional[float] = None, units: Optional[str] = None) -> dict[str, Any]:
    """Find the filter behind a logged straight move or corner, from rest to rest.

    The feed need not be known; each leg needs a part at constant speed.

    Parameters
    ----------
    log : path or dict
        A table as `accdec identify` reads it, or the positions of every axis (m), one a sample period.
    task : Task, path or dict
        With the sample period. All families are tried, whatever it names. If it has prefilter_taps, the filter found
        is the one in front of them.
    noise : float, optional
        m, standard deviation of the positions. Default: what the best fit leaves.
    feed : float, optional
        m/s, the programmed feed of the move, or of the first leg. Default: any that explains the log.
    units : str, optional
        Units of times and positions in columns of a file whose names have none, such as "s,mm" for t,x,y.

    Returns
    -------
    dict
        fits: those that fit, each with family, filter (as a task takes it), rms (m), sigmas behind the first (below 0:
        it fits better), likelihood (a share of those listed, numbers counted; 0 for taps), time_constant (s, of a pole
        or an exponential) and second_constant (s, of a second pole in series; 0: none), aliases and moves. The first
        explains the log with the fewest numbers. aliases: family and filter of other names for the same taps; real
        numbers, which are fitted, make them within 1 %. Moves are first sample, samples, first_step and last_step (parts
        of the others that the first and the last sample move) and way (m) of each leg. taps: any taps, likewise.
        noise (m). rounding (m), the noise that positions have because they are written in steps; 0: a family fits
        exactly. moves: those of the first fit. modelled: positions of the first fit (m), by axis.

    Examples
    --------
    >>> import accdec, numpy as np
    >>> command = 1e-4 * np.clip(np.arange(400) - 50, 0, 200)              # 20 mm at 100 mm/s
    >>> taps = accdec.taps("averages", lengths=[18, 7])
    >>> logged = np.convolve(np.pad(command, (len(taps) - 1, 0)), taps, "valid")
    >>> accdec.identify({"x": logged}, {"sample_period": 1e-3})["fits"][0]["filter"]
    {'kind': 'averages', 'lengths': [18, 7]}
    """
    if noise is not None:
        noise = arguments.number("noise", noise, "must be a number of metres from 1e-15 to 1", 1e-15, 1.0)
    if feed is not None:
        feed = arguments.number("feed", feed, "must be a number of m/s from 1e-6 to 1000", 1e-6, 1000.0)
    if units is not None:
        units = arguments.text("units", units)
        if isinstance(log, Mapping):
            raise ValueError("units: belongs to a file; positions by axis are in m")
    axes: list[str] = []
    positions: list[list[float]] = []
    file = ""
    if isinstance(log, Mapping):
        axes, positions = [arguments.text("log", axis) for axis in log], _positions(log)
    else:
        file = arguments.path("log", log)
    return _core.identify(as_task(task, program=True), file=file, axes=axes, positions=positions, noise=noise,
                          feed=feed, units=units or "", progress=None)
