"""Tasks, results, explanations and programs as notebooks and `help` show them."""

from __future__ import annotations

import inspect
import shutil
from html import escape
from typing import Any

from . import _core
from ._fields import FIELDS
from ._plot import plot


def _text(of: object) -> str:
    return f"<pre>{escape(str(of))}</pre>"


def task_html(self: _core.Task) -> str:
    """The text of the task file."""
    return _text(self)


def result_html(self: _core.Result) -> str:
    """The summary, and the figure where there is a filter and gnuplot to draw it."""
    if self.x is None or not shutil.which("gnuplot"):
        return _text(self)
    drawing = plot(self).svg
    return _text(self) + drawing[drawing.index("<svg"):]


def explanation_html(self: _core.Explanation) -> str:
    """Its sentences."""
    return _text(self)


def program_html(self: _core.Program) -> str:
    """The page to zoom into, in a frame that keeps its style and script; the summary where there is no motion."""
    try:
        page = self.page()
    except RuntimeError:
        return _text(self)
    return _text(self) + (f'<iframe srcdoc="{escape(page)}" sandbox="allow-scripts" '
                          'style="width:100%;height:720px;border:1px solid #ccc"></iframe>')


def _signature() -> inspect.Signature:
    kinds = inspect.Parameter
    fields: list[Any] = [kinds("program", kinds.POSITIONAL_OR_KEYWORD, default=False)]
    fields += [kinds(name, kinds.KEYWORD_ONLY, default=None) for name in FIELDS]
    return inspect.Signature([*fields, kinds("tables", kinds.VAR_KEYWORD)])


for made, html in ((_core.Task, task_html), (_core.Result, result_html), (_core.Explanation, explanation_html),
                   (_core.Program, program_html)):
    setattr(made, "_repr_html_", html)
setattr(_core.Task, "__signature__", _signature())
