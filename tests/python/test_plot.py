"""Figures and exports."""
import io
import json
import os
import subprocess

import numpy as np
import pytest

import accdec
from accdec import _plot


@pytest.fixture(scope="module")
def result():
    return accdec.design(dict(
        sample_period=1e-3, axes={"acceleration_max": 6.0, "jerk_max": 500.0, "mass": 34, "force_max": 250},
        modes={"frequency": [30, 34], "residual_max": 0.3},
        corners={"angle_deg": 95, "feed_in": 0.1, "error_max": 50e-6}))


def test_the_curves_are_the_simulation(result):
    figure, motion = accdec.plot(result), accdec.simulate(result)
    drawn = {axes.get_title(): axes for axes in figure.axes}
    velocity = next(axes for title, axes in drawn.items() if title.startswith("velocity x"))
    x, y = velocity.lines[0].get_data()
    assert np.allclose(x, 1e3 * motion["time"], atol=1e-9) and np.allclose(y, 1e3 * motion["velocity"][:, 0], atol=1e-9)
    force = next(axes for title, axes in drawn.items() if title.startswith("force x"))
    assert any(np.allclose(line.get_ydata(), 250.0) for line in force.lines)  # the limit


def test_every_panel_of_the_program_is_there(result):
    figure = accdec.plot(result)
    panels = accdec._core.result_figure(result, "")["panels"]
    titles = [axes.get_title() for axes in figure.axes]
    assert titles[:len(panels)] == [panel["title"] for panel in panels]
    colours = accdec._core.figure_style()["colours"]
    for axes, panel in zip(figure.axes, panels):
        wanted = {colours[series["style"] % len(colours)] for series in panel["series"] if series["mark"] == "line"}
        assert wanted <= {line.get_color() for line in axes.lines}


def test_figures_are_saved(result, tmp_path):
    accdec.plot(result, path=tmp_path / "corner.png")
    assert (tmp_path / "corner.png").read_bytes().startswith(b"\x89PNG")
    with pytest.raises(ValueError, match="no corner"):
        accdec.plot(result, "Z")
    with pytest.raises(TypeError):
        accdec.plot("result")


@pytest.mark.parametrize("mark", ["line", "points", "line_points", "steps", "impulses", "bars", "marked_line"])
def test_every_mark_is_drawn(mark):
    scale = {"label": "s", "log": False, "min": None, "max": None}
    panel = {"title": "t", "x": scale, "y": scale, "limits": [(1.5, "limit")], "bands": [(0.2, 0.4, "mode")],
             "circles": [(0.0, 0.0, 1.0, "error")], "heat_map": None, "coloured": None, "equal_aspect": False,
             "has_data": True, "series": [{"label": "a", "x": np.arange(9.0), "y": np.arange(9.0), "mark": mark,
                                           "style": 9}]}
    figure = _plot.draw({"title": "f", "panels": [panel], "columns": 1, "panel_width": 400, "panel_height": 300})
    axes = figure.axes[0]
    assert len(axes.lines) + len(axes.collections) + len(axes.patches) >= 4
    assert axes.get_legend() is not None
    figure.savefig(io.BytesIO(), format="svg")


def test_heat_maps_and_coloured_lines_are_drawn():
    scale = {"label": "s", "log": False, "min": None, "max": None}
    empty = {"title": "t", "x": {**scale, "log": True}, "y": scale, "limits": [], "bands": [], "circles": [],
             "series": [], "heat_map": None, "coloured": None, "equal_aspect": False, "has_data": True}
    heat = {"x": np.array([1.0, 2.0, 4.0]), "y": np.array([0.0]), "values": np.array([1.0, np.nan, 3.0]), "label": "z"}
    signed = {**heat, "values": np.array([-1.0, 0.0, 3.0])}
    coloured = {"pieces": [(np.array([1.0, 2.0]), np.array([0.0, 1.0]), 30.0)], "low": 0.0, "high": 100.0,
                "line_width": 1.8, "label": "use"}
    panels = [{**empty, "heat_map": heat}, {**empty, "heat_map": signed}, {**empty, "coloured": coloured}]
    figure = _plot.draw({"title": "f", "panels": panels, "columns": 2, "panel_width": 400, "panel_height": 300})
    assert len(figure.axes) == 6  # with colour bars
    assert figure.axes[1].collections[0].norm.vmin == -3.0 or any(
        c.norm.vmin == -3.0 for axes in figure.axes for c in axes.collections)


def test_exports_are_those_of_the_program(result, tmp_path):
    result.write(tmp_path / "result.json")
    for format in ("csv", "c", "json", "npy", "m", "st", "linuxcnc-comp"):
        program = subprocess.run([os.environ["ACCDEC_BINARY"], "export", tmp_path / "result.json", "--format", format],
                                 capture_output=True, check=True).stdout
        ours = accdec.export(result, format, tmp_path / "taps")
        assert (ours if format == "npy" else ours.encode()) == program == (tmp_path / "taps").read_bytes()
    assert np.array_equal(np.load(io.BytesIO(accdec.export(result, "npy"))), result.x)
    assert json.loads(accdec.export(result, "json"))["order"] == result.order
    with pytest.raises(ValueError, match="csv"):
        accdec.export(result, "xls")
