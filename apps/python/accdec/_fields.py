"""What a user writes, as the tables of a task file: single tables for lists of one, arrays for filters."""

from __future__ import annotations

import difflib
import json
import math
import os
from typing import Any, Mapping

import numpy as np

from . import _core
from ._arguments import array, wrong

_LISTS = {"axes": "axis", "corners": "corner", "modes": "mode"}
_DESIGN = ("order_min", "order_max", "symmetric", "objective", "runs", "coefficient_bits", "family", "stages",
           "shaper", "length_step", "length_max", "length_set", "length_set_2", "length_set_3",
           "time_constant_step", "alpha_step", "cutoff_step", "shaper_frequency_step")
# Arguments of the constructor.
FIELDS = ("title", "sample_period", *_LISTS, "filter", "baseline", "controller", "machine", *_DESIGN)
# The same as a task file has them.
_FILE = ("sample_period_ms", *_LISTS.values(), "design", "program")


def _require_known(name: str) -> None:
    if name in FIELDS or name in _FILE:
        return
    near = difflib.get_close_matches(name, FIELDS, 1)
    hint = f"did you mean `{near[0]}`?" if near else f"known are {', '.join(FIELDS)}"
    raise _core.InputError(f"task: unknown argument `{name}`; {hint}")


def _plain(value: Any, name: str) -> Any:
    """NumPy's numbers and arrays as Python's; None and infinite limits left out."""
    if isinstance(value, np.ndarray):
        value = value.tolist()
    elif isinstance(value, np.generic):
        value = value.item()
    if isinstance(value, Mapping):
        return {str(k): _plain(v, str(k)) for k, v in value.items()
                if v is not None and not (isinstance(v, float) and v == math.inf)}
    if isinstance(value, (list, tuple)):
        return [_plain(v, name) for v in value]
    if isinstance(value, float) and not math.isfinite(value):
        raise _core.InputError(f"task: `{name}` is {value}; a finite number is needed")
    if isinstance(value, (str, bool, int, float)):
        return value
    raise TypeError(f"task: `{name}` is a {type(value).__name__}; allowed are numbers, texts, lists and dicts")


def _filter(name: str, value: Any) -> Any:
    """Taps in place of a table."""
    if isinstance(value, (np.ndarray, list, tuple)):
        return {"kind": "taps", "taps": array(name, value).tolist()}
    return value


def tables(fields: Mapping[str, Any]) -> dict[str, Any]:
    """The tables of a task file, still with SI names where they were given so."""
    task: dict[str, Any] = {}
    for name, value in fields.items():
        _require_known(name)
        if value is None:
            continue
        key = _LISTS.get(name, name)
        if key in task and key != "design":
            raise TypeError(f"task: `{name}` is given twice")
        if key in _LISTS.values() and isinstance(value, Mapping):
            value = [value]
        if key in ("filter", "baseline"):
            value = _filter(name, value)
        if key in _DESIGN:
            task.setdefault("design", {})[key] = _plain(value, key)
        elif key == "design":
            task.setdefault("design", {}).update(_plain(value, key))
        else:
            task[key] = _plain(value, key)
    return task


def to_json(fields: Mapping[str, Any]) -> str:
    return json.dumps(tables(fields))


def to_dict(task: _core.Task) -> dict[str, Any]:
    """The task as the tables of a task file, every axis written out.

    Reading it back, ``Task(**accdec.to_dict(task))``, gives the same task to the last bit.
    """
    made: dict[str, Any] = json.loads(task._json())
    return made


def replaced(task: _core.Task, fields: Mapping[str, Any]) -> _core.Task:
    old = to_dict(task)
    new = tables(fields)
    if "sample_period" in new:
        del old["sample_period_ms"]
    if "design" in new:
        new["design"] = {**old["design"], **new["design"]}
    # Fields set to None are left out.
    gone = [_LISTS.get(name, name) for name, value in fields.items() if value is None]
    merged = {key: value for key, value in {**old, **new}.items() if key not in gone}
    if "design" in merged:
        merged["design"] = {key: value for key, value in merged["design"].items() if key not in gone}
    return _core.Task(program=not merged.get("corner"), **merged)


def as_task(given: Any, *, program: bool = False, complete: bool = False) -> _core.Task:
    """A task, or what makes one: a path of a task file, or a dict of fields."""
    if isinstance(given, _core.Task):
        return given
    if isinstance(given, (str, os.PathLike)):
        return _core.Task.read(given, program=program, given=complete)
    if isinstance(given, Mapping):
        return _core.Task(program=program, **given)
    raise wrong("task", "must be a Task, the path of a task file or a dict", given, TypeError)
