"""Figures and exports."""
import io
import json
import os
import subprocess
import xml.etree.ElementTree as xml

import numpy as np
import pytest

import accdec


@pytest.fixture(scope="module")
def result():
    return accdec.design(dict(
        sample_period=1e-3, axes={"acceleration_max": 6.0, "jerk_max": 500.0, "mass": 34, "force_max": 250},
        modes={"frequency": [30, 34], "residual_max": 0.3},
        corners={"angle_deg": 95, "feed_in": 0.1, "error_max": 50e-6}))


def test_figures_are_those_of_the_program(result, tmp_path):
    result.write(tmp_path / "result.json")
    figure = accdec.plot(result)
    assert xml.fromstring(figure.svg.encode()).tag.endswith("svg") and figure._repr_svg_() == figure.svg
    for kind in ("svg", "html"):
        ours, theirs = tmp_path / f"ours.{kind}", tmp_path / f"theirs.{kind}"
        figure.savefig(ours)
        subprocess.run([os.environ["ACCDEC_BINARY"], "plot", tmp_path / "result.json", "--out", theirs], check=True,
                       capture_output=True)
        assert ours.read_bytes() == theirs.read_bytes()


def test_figures_are_saved(result, tmp_path):
    accdec.plot(result, path=tmp_path / "corner.png")
    assert (tmp_path / "corner.png").read_bytes().startswith(b"\x89PNG")
    with pytest.raises(ValueError, match="no corner"):
        accdec.plot(result, "Z")
    with pytest.raises(ValueError, match=r"did you mean \.svg\?"):
        accdec.plot(result, path=tmp_path / "corner.svgz")
    with pytest.raises(TypeError):
        accdec.plot("result")


def test_what_draws_is_named_where_it_is_missing(result, monkeypatch):
    monkeypatch.setenv("PATH", "/nonexistent")
    with pytest.raises(RuntimeError, match="gnuplot is not installed .Debian package gnuplot-nox."):
        accdec.plot(result)
    assert "<svg" not in result._repr_html_()


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
