"""Filters and the motion around corners."""

from __future__ import annotations

from typing import Any, Optional, Union

import numpy as np
import numpy.typing as npt

from . import _arguments as arguments
from . import _core
from ._core import Result, Task
from ._design import TaskLike
from ._fields import as_task

Array = npt.NDArray[np.float64]
_CORNERS_AT_ONCE = 1 << 18  # a part of a second, so that Ctrl-C is heard between them


def taps(kind: str, order: Optional[int] = None, **parameters: Any) -> Array:
    """The taps of a named shape, normalised to sum 1.

    Parameters
    ----------
    kind : str
        "boxcar", "trapezoid", "averages", "s-curve", "hann", "blackman", "blackman-sinc", "gaussian", "exponential".
    order : int, optional
        N, for N + 1 taps; of "averages" it follows from the lengths.
    **parameters
        The shape's own as in [filter] of a task file: ramp, lengths, cutoff, alpha, ratio; shaper and shaper_delay.

    Returns
    -------
    ndarray
        b_0 .. b_N.

    Examples
    --------
    >>> import accdec
    >>> accdec.taps("trapezoid", order=4, ramp=1) * 8
    array([1., 2., 2., 2., 1.])
    """
    arguments.text("kind", kind)
    made = _core.Task(program=True, sample_period_ms=1.0, filter={"kind": kind, "order": order, **parameters}).taps
    assert made is not None
    return made


def _corner_index(task: Task, corner: Union[str, int, None]) -> int:
    names = [c["name"] for c in task.corners]
    if corner is None:
        return 0
    if isinstance(corner, str):
        if corner not in names:
            raise ValueError(f'the task has no corner "{corner}"; it has: {", ".join(names)}')
        return names.index(corner)
    return arguments.whole("corner", corner, 0, len(names) - 1)


def simulate(of: Union[Result, TaskLike], corner: Union[str, int, None] = None, *,
             taps: Optional[npt.ArrayLike] = None, delay: Optional[int] = None) -> dict[str, Any]:
    """The sampled motion of one corner, from rest to rest.

    Parameters
    ----------
    of : Result, Task, path or dict
        Filter and delay are taken from here unless given.
    corner : str or int, optional
        Its name, or its number from 0. The default is the first.
    taps : array_like, optional
    delay : int, optional
        Samples, at most a million.

    Returns
    -------
    dict of ndarray
        `time` (s, 0 at the last command sample of leg 1), and, samples by axes, `position` (m from the corner
        point), `velocity` (m/s), `acceleration` (m/s^2), `jerk` (m/s^3), `force` (N), `power` (W, motoring > 0);
        `start`, `corner`, `stop`: the rows at which the three events begin. If the task has a response (`servo_gain`,
        `response_taps`, `prefilter_taps`), these are of the motion behind it, and `command_position`,
        `command_velocity`, `command_acceleration` and `command_jerk` are of the command before the servo.

    Examples
    --------
    >>> import accdec
    >>> task = accdec.Task(sample_period=1e-3, corners={"angle_deg": 90, "feed_in": 0.1})
    >>> motion = accdec.simulate(task, taps=accdec.taps("boxcar", 9), delay=4)
    >>> motion["velocity"].max().round(6), motion["acceleration"].max().round(6)  # m/s, 0.1/10 ms
    (0.1, 10.0)
    """
    if isinstance(of, Result):
        task = of.task
        index = _corner_index(task, corner)
        taps = of.x if taps is None else taps
        if delay is None and of.x is not None:
            delay = int(of.delays[index])
    else:
        task = as_task(of)
        index = _corner_index(task, corner)
        taps = task.taps if taps is None else taps
        if delay is None:
            delay = task.corners[index]["delay"]
    if taps is None:
        raise ValueError("taps: there is no filter to simulate, so the taps are needed")
    if delay is None:
        raise ValueError("delay: the task leaves it open, so it is needed")
    return _core.simulate(task, arguments.vector("taps", taps), index,
                          arguments.whole("delay", delay, 0, arguments.MOST_SAMPLES))


def smallest_delay(taps: npt.ArrayLike, angle: npt.ArrayLike, feed_in: npt.ArrayLike, error_max: npt.ArrayLike, *,
                   feed_out: Optional[npt.ArrayLike] = None, sample_period: float) -> npt.NDArray[np.int32]:
    """The smallest command delay that brings a corner's error within a bound, for many corners at once.

    Arrays are broadcast against each other. Limits of axes are ignored; `design` with a given filter uses them.

    Parameters
    ----------
    taps : array_like
        b_0 .. b_N, one filter for all corners.
    angle : array_like
        rad, interior, 0 < angle <= pi; pi is straight on.
    feed_in : array_like
        m/s, > 0.
    error_max : array_like
        m, >= 0, bound on the error at samples.
    feed_out : array_like, optional
        m/s. The default is `feed_in`.
    sample_period : float
        s.

    Returns
    -------
    ndarray of int
        Samples, of the broadcast shape (a scalar array for scalars).

    Examples
    --------
    >>> import accdec, numpy as np
    >>> filter = accdec.taps("boxcar", 19)
    >>> accdec.smallest_delay(filter, np.pi / 2, 0.1, np.array([0, 20e-6, 50e-6, 500e-6]), sample_period=1e-3)
    array([19, 16, 13,  0], dtype=int32)
    """
    period = arguments.seconds("sample_period", sample_period)
    find = _core.DelayFinder(arguments.vector("taps", taps))
    given = {"angle": angle, "feed_in": feed_in, "feed_out": feed_in if feed_out is None else feed_out,
             "error_max": error_max}
    arrays = [arguments.array(name, values) for name, values in given.items()]
    try:
        np.broadcast_shapes(*(a.shape for a in arrays))
    except ValueError:
        shapes = ", ".join(f"{name} {a.shape}" for name, a in zip(given, arrays))
        raise ValueError(f"{', '.join(given)}: shapes that do not go together, {shapes}") from None
    operands: Any = [*arrays, None]
    access: Any = [["readonly"]] * 4 + [["writeonly", "allocate"]]
    parts = np.nditer(operands, flags=["external_loop", "buffered", "zerosize_ok", "delay_bufalloc"], order="C",
                      op_flags=access, op_dtypes=[np.float64] * 4 + [np.int32], buffersize=_CORNERS_AT_ONCE)
    with parts:
        parts.reset()
        for theta, v_in, v_out, bound, found in parts:
            _check_corners(theta, v_in, v_out, bound)
            found[...] = find(np.cos(theta), v_in * period, v_out * period, bound)
        return parts.operands[4]


def _check_corners(theta: Array, v_in: Array, v_out: Array, bound: Array) -> None:
    for name, values, ok, allowed in (
        ("angle", theta, (theta > 0.0) & (theta <= np.pi), "0 < angle <= pi (rad)"),
        ("feed_in", v_in, (v_in > 0.0) & np.isfinite(v_in), "feed_in > 0 (m/s)"),
        ("feed_out", v_out, (v_out > 0.0) & np.isfinite(v_out), "feed_out > 0 (m/s)"),
        ("error_max", bound, bound >= 0.0, "error_max >= 0 (m)"),
    ):
        if not np.all(ok):
            raise ValueError(f"{name}: allowed is {allowed}, got {values[~ok].flat[0]}")


def residual_vibration(taps: npt.ArrayLike, frequency: npt.ArrayLike, sample_period: float) -> Array:
    """The residual amplitude of an undamped mode after a filtered step, divided by that after an unfiltered step.

    Parameters
    ----------
    taps : array_like
        b_0 .. b_N.
    frequency : array_like
        Hz.
    sample_period : float
        s.

    Returns
    -------
    ndarray
        ``|sum_i b_i exp(-2 pi j f i T)|``, 0 .. 1, of the shape of `frequency`.

    Examples
    --------
    >>> import accdec
    >>> accdec.residual_vibration([0.5, 0, 0, 0, 0.5], [0.0, 125.0], 1e-3).round(12)  # a ZV shaper for 125 Hz
    array([1., 0.])
    """
    f = arguments.array("frequency", frequency)
    if not np.isfinite(f).all():
        raise arguments.wrong("frequency", "must be finite", f[~np.isfinite(f)][0])
    period = arguments.seconds("sample_period", sample_period)
    return _core.residual_vibration(arguments.vector("taps", taps), f.ravel(), period).reshape(f.shape)
