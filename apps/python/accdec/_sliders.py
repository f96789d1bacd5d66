"""Sliders of a task in a notebook, where ipywidgets is installed."""

from __future__ import annotations

from html import escape
from typing import Any, Callable

from . import _arguments as arguments
from . import _core
from ._design import design
from ._fields import as_task, to_dict
from ._notebook import result_html

_NO_SLIDER = ("weight", "delay_samples")


def _range(key: str, value: float) -> dict[str, float]:
    """From a tenth to the threefold, or to one where it is zero; angles up to 180 degrees, headings all around."""
    if key == "heading_deg":
        return {"min": min(-180.0, value), "max": max(180.0, value), "step": 1.0}
    high = 180.0 if key == "angle_deg" else 3.0 * value or 1.0
    return {"min": 0.1 * value, "max": high, "step": 0.01 * value or 0.01}


def sliders(task: Any, *, time_limit: float = 2.0) -> Any:
    """A slider for every limit, angle, feed and tolerance of a task; each change is designed and drawn.

    For notebooks with ipywidgets (Debian package ``python3-ipywidgets``). ``accdec explore`` shows more in a browser.

    Parameters
    ----------
    task : Task, path or dict
    time_limit : float
        Seconds for each design.

    Returns
    -------
    ipywidgets.VBox
        Its ``task`` is what the sliders say, and its ``result`` the design of it; None after an error.

    Raises
    ------
    ImportError
        Without ipywidgets.
    InputError

    Examples
    --------
    >>> box = accdec.sliders("machine.toml")  # doctest: +SKIP
    >>> box  # in a notebook: the sliders; then move them  # doctest: +SKIP
    >>> accdec.export(box.result, "c", "taps.h")  # doctest: +SKIP
    """
    given = as_task(task)
    seconds = arguments.seconds("time_limit", time_limit)
    try:
        import ipywidgets
    except ImportError:
        raise ImportError("sliders need ipywidgets (Debian package python3-ipywidgets)") from None
    tables = to_dict(given)
    shown = ipywidgets.HTML()
    box = ipywidgets.VBox()

    def design_again() -> None:
        try:
            box.task = _core.Task(**tables)
            box.result = design(box.task, time_limit=seconds)
            shown.value = result_html(box.result)
        except _core.InputError as error:
            box.result = None
            shown.value = f"<pre>{escape(str(error))}</pre>"

    def follows(table: dict[str, Any], key: str) -> Callable[[Any], None]:
        def moved(change: Any) -> None:
            table[key] = change["new"]
            design_again()
        return moved

    made = []
    for kind in ("axis", "corner", "mode"):
        for i, table in enumerate(tables.get(kind, [])):
            for key, value in table.items():
                if isinstance(value, (str, bool, list, dict)) or key in _NO_SLIDER:
                    continue
                if not value >= 0 and key != "heading_deg":
                    continue
                slider = ipywidgets.FloatSlider(value=value, continuous_update=False, **_range(key, value))
                slider.observe(follows(table, key), names="value")
                words = ipywidgets.Label(f"{kind} {table.get('name', i + 1)} {key}", layout={"width": "22em"})
                made.append(ipywidgets.HBox([words, slider]))
    box.children = [*made, shown]
    design_again()
    return box
