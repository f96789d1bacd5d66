"""Arguments as users give them: what is wrong is named, with what is allowed, in the words of the command line."""

from __future__ import annotations

import math
import os
from typing import Any, Callable, Mapping, Optional, Sequence, Union

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]
MOST_SAMPLES = 1_000_000  # of a delay, as in task files


def shown(value: Any) -> str:
    """A value for a message: texts in double quotes, long ones cut."""
    text = f'"{value}"' if isinstance(value, str) else repr(value)
    return text if len(text) <= 60 else text[:57] + "..."


def wrong(name: str, allowed: str, value: Any, kind: type[Exception] = ValueError) -> Exception:
    return kind(f"{name}: {allowed}, got {shown(value)}")


def number(name: str, value: Any, allowed: str, low: float = -math.inf, high: float = math.inf) -> float:
    """A number, low <= it <= high; `allowed` says so in words. NaN never is."""
    try:
        if isinstance(value, (str, bytes, bool, np.bool_)):
            raise TypeError
        found = float(value)
    except (TypeError, ValueError, OverflowError):
        raise wrong(name, allowed, value, TypeError) from None
    if not low <= found <= high:
        raise wrong(name, allowed, value)
    return found


def real(name: str, value: Any) -> float:
    return number(name, value, "must be a number")


def seconds(name: str, value: Any) -> float:
    return number(name, value, "must be a number of seconds > 0 and at most 1e9", math.ulp(0.0), 1e9)


def whole(name: str, value: Any, low: int, high: int) -> int:
    """A whole number, also one of NumPy or a float without a fraction."""
    allowed = f"must be a whole number from {low} to {high}"
    found = number(name, value, allowed, low, high)
    if found != math.floor(found):
        raise wrong(name, allowed, value)
    return int(value)


def seed(value: Any) -> int:
    return whole("seed", value, 0, 10**19 - 1)


def flag(name: str, value: Any) -> bool:
    if not isinstance(value, (bool, np.bool_)):
        raise wrong(name, "must be True or False", value, TypeError)
    return bool(value)


def one_of(name: str, value: Any, words: Sequence[str]) -> str:
    if value not in words:
        allowed = ", ".join(f'"{word}"' for word in words[:-1]) + f' and "{words[-1]}"'
        raise wrong(name, f"allowed are {allowed}", value)
    return str(value)


def text(name: str, value: Any) -> str:
    if not isinstance(value, str):
        raise wrong(name, "must be a text", value, TypeError)
    return value


def path(name: str, value: Any) -> str:
    if not isinstance(value, (str, os.PathLike)):
        raise wrong(name, "must be a path", value, TypeError)
    return str(os.fspath(value))


def array(name: str, value: Any) -> Array:
    """Numbers of any shape, NaN and infinite ones among them."""
    try:
        return np.asarray(value, dtype=float)
    except (TypeError, ValueError):
        raise wrong(name, "must be numbers", value, TypeError) from None


def vector(name: str, value: Any) -> Array:
    """Finite numbers in one dimension, at least one."""
    found = array(name, value)
    if found.ndim != 1 or found.size == 0:
        raise wrong(name, "must be one row of numbers", value)
    if not np.isfinite(found).all():
        raise wrong(name, "must be finite numbers", found[~np.isfinite(found)][0])
    return found


def delays(value: Any, corners: int) -> list[int]:
    """Whole samples, one a corner."""
    if isinstance(value, (str, bytes)) or not hasattr(value, "__iter__"):
        raise wrong("delays", f"must be {corners} whole numbers, one a corner", value, TypeError)
    found = [whole("delays", d, 0, MOST_SAMPLES) for d in value]
    if len(found) != corners:
        raise ValueError(f"delays: {len(found)} for {corners} corners")
    return found


def native(value: Optional[Mapping[str, Any]]) -> dict[str, str]:
    """A solver's own options."""
    if value is not None and not isinstance(value, Mapping):
        raise wrong("options", "must be a dict", value, TypeError)
    return {str(key): str(v) for key, v in (value or {}).items()}


def listener(progress: Union[bool, Callable[..., object], None],
             printed: Callable[..., object] = print) -> Optional[Callable[..., object]]:
    """Whom to tell: `printed` for True."""
    if progress is None or progress is False:
        return None
    if progress is True:
        return printed
    if not callable(progress):
        raise wrong("progress", "must be True, False or something to call", progress, TypeError)
    return progress
