"""Arguments of users as the tables of a task file: single tables for lists of one, arrays for filters."""

from __future__ import annotations

import difflib
import json
import math
import os
import re
from typing import Any, Callable, Mapping, Union

import numpy as np

from . import _core
from ._arguments import array, flag, wrong

_LISTS = {"axes": "axis", "corners": "corner", "modes": "mode"}
_DESIGN = ("order_min", "order_max", "symmetric", "objective", "runs", "coefficient_bits", "family", "stages",
           "shaper", "length_step", "length_max", "length_set", "length_set_2", "length_set_3",
           "time_constant_step", "alpha_step", "cutoff_step", "shaper_frequency_step")
# Arguments of the constructor.
FIELDS = ("title", "sample_period", *_LISTS, "filter", "baseline", "controller", "machine", *_DESIGN)
# The same as a task file has them.
_FILE = ("sample_period_ms", *_LISTS.values(), "design", "program")


_PLURALS = {table: name for name, table in _LISTS.items()}
# The words of task files and of the command line, and Python's for the same.
_WORDS: list[tuple[str, Union[str, Callable[[re.Match[str]], str]]]] = [
    (r"\[\[(axis|corner|mode)\]\] (\d+)", lambda m: f"{_PLURALS[m[1]]}[{int(m[2]) - 1}]"),
    (r"`(axis|corner|mode)`(?= must (be a list of|hold) tables)", lambda m: f"`{_PLURALS[m[1]]}`"),
    (r"a list of tables \[\[\w+\]\]", "a dict or a list of dict"),
    (r"hold tables \[\[\w+\]\]", "hold dicts"),
    (r"one \[\[(axis|corner|mode)\]\]", r"one \1"),
    (r"\[\[(axis|corner|mode)\]\]", lambda m: _PLURALS[m[1]]),
    (r"/(axis|corner|mode)/(\d+)/(\w+)", lambda m: f"{_PLURALS[m[1]]}[{m[2]}].{m[3]}"),
    (r"a table \[(filter|baseline)\]", "taps or a dict"),
    (r"a table \[\w+\]", "a dict"),
    (r"\[design\] (\w+)", r"\1"),
    (r"\[(machine|controller|program)\] (\w+)", r"\2 of `\1`"),
    (r"(?<![\w`])\[(machine|filter|baseline|controller|program)\]", r"`\1`"),
    (r"the task \(top level\)", "a task"),
    (r"a string in quotes", "a text"),
    (r"a list of strings", "a list of texts"), (r"a string\b", "a text"),
    (r"an array of numbers", "a list of numbers"),
    (r"got an array", "got a list"), (r"got a table", "got a dict"), (r"got a boolean", "got a bool"),
    (r"\b(got|is) an integer", r"\1 an int"), (r"got a number with a fraction", "got a float"),
    (r"must be true or false", "must be True or False"), (r"got true\b", "got True"), (r"got false\b", "got False"),
    (r"(?<![\w/-])--(plan|feeds|method) (\w+)", r'\1="\2"'),
    (r"(?<![\w/-])--([a-z]+(?:-[a-z]+)*)", lambda m: m[1].replace("-", "_")),
]


def in_python_words(message: str, pointer: str = "", written: str = "") -> str:
    """A message of the reader of task files in Python's words, with the place of an entry among several.

    `pointer` is a JSON pointer in the JSON that was `written`.
    """
    for pattern, words in _WORDS:
        message = re.sub(pattern, words, message)
    _, table, number, *_ = [*pointer.split("/"), "", "", ""]
    place = f"{_PLURALS.get(table)}[{number}]"
    if table in _PLURALS and number.isdigit() and place not in message and len(json.loads(written).get(table, ())) > 1:
        return f"{place}: {message}"
    return message


def _require_known(name: str) -> None:
    if name in FIELDS or name in _FILE:
        return
    near = difflib.get_close_matches(name, FIELDS, 1)
    hint = f"did you mean `{near[0]}`?" if near else f"known are {', '.join(FIELDS)}"
    raise _core.InputError(f"task: unknown argument `{name}`; {hint}")


def _plain(value: Any, name: str, place: str = "") -> Any:
    """NumPy's numbers and arrays as Python's; None and infinite limits left out."""
    if isinstance(value, np.ndarray):
        value = value.tolist()
    elif isinstance(value, np.generic):
        value = value.item()
    if isinstance(value, Mapping):
        return {str(k): _plain(v, str(k), place) for k, v in value.items()
                if v is not None and not (isinstance(v, float) and v == math.inf)}
    if isinstance(value, (list, tuple)):
        entries = name in _LISTS and len(value) > 1
        return [_plain(v, name, f"{name}[{i}]: " if entries else place) for i, v in enumerate(value)]
    if isinstance(value, float) and not math.isfinite(value):
        raise _core.InputError(f"task: {place}`{name}` is {value}; a finite number is needed")
    if isinstance(value, (str, bool, int, float)):
        return value
    raise TypeError(f"task: {place}`{name}` is a {type(value).__name__}; allowed are numbers, texts, lists and dicts")


def _filter(name: str, value: Any) -> Any:
    """Taps in place of a table."""
    if isinstance(value, (np.ndarray, list, tuple)):
        return {"kind": "taps", "taps": array(name, value).tolist()}
    return value


def _without_angle(corner: Any) -> Any:
    """Corners of a Task have both the angle and the directions that it follows from; files have either."""
    if not isinstance(corner, Mapping) or not {"angle", "direction_in", "direction_out"} <= corner.keys():
        return corner
    try:
        cosine = -np.dot(corner["direction_in"], corner["direction_out"]) / (
            np.linalg.norm(corner["direction_in"]) * np.linalg.norm(corner["direction_out"]))
        same = abs(cosine - math.cos(corner["angle"])) < 1e-9
    except (TypeError, ValueError):
        return corner
    return {key: value for key, value in corner.items() if key != "angle"} if same else corner


def tables(fields: Mapping[str, Any]) -> dict[str, Any]:
    """The tables of a task file, still with SI names where they were given so."""
    task: dict[str, Any] = {}
    for name, value in fields.items():
        _require_known(name)
        if value is None:
            continue
        key = _LISTS.get(name, name)
        if key == "axis" and isinstance(value, (list, tuple)) and not value:
            raise _core.InputError(f"task: `{name}` is an empty list; without it, axes have no limits")
        if key in task and key != "design":
            raise TypeError(f"task: `{name}` is given twice")
        if key in _LISTS.values() and isinstance(value, Mapping):
            value = [value]
        if key in ("filter", "baseline"):
            value = _filter(name, value)
        if key in _DESIGN:
            task.setdefault("design", {})[key] = _plain(value, name)
        elif key == "design":
            task.setdefault("design", {}).update(_plain(value, name))
        else:
            task[key] = _plain(value, name)
            if key == "corner" and isinstance(task[key], list):
                task[key] = [_without_angle(corner) for corner in task[key]]
    return task


def to_json(fields: Mapping[str, Any]) -> str:
    return json.dumps(tables(fields))


def parted(fields: Mapping[str, Any]) -> tuple[str, bool]:
    """The task as JSON, and whether it is one for a whole program: `program` says so, or has that table's keys."""
    rest = {name: value for name, value in fields.items() if name not in ("program", "_program")}
    program = fields["program"]
    if not isinstance(program, Mapping):
        return to_json(rest), flag("program", program)
    made = tables({**rest, "program": program})
    return json.dumps(made), fields.get("_program", False) or not made.get("corner")


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
    whole: dict[str, Any] = {"program": not merged.get("corner"), **merged}
    return _core.Task(**whole)


def as_task(given: Any, *, program: bool = False, complete: bool = False) -> _core.Task:
    """A task, or what makes one: a path of a task file, or a dict of fields."""
    if isinstance(given, _core.Task):
        return given
    if isinstance(given, (str, os.PathLike)):
        return _core.Task.read(given, program=program, given=complete)
    if isinstance(given, Mapping):
        fields: dict[str, Any] = {"program": program, **given, "_program": program}
        return _core.Task(**fields)
    raise wrong("task", "must be a Task, the path of a task file or a dict", given, TypeError)
