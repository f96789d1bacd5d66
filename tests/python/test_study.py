"""Studies and comparisons as tables: the rows of the command line."""
import os
import signal
import subprocess

import pandas
import pytest

import accdec

TASK = """
sample_period_ms = 1.0
[[axis]]
acceleration_max_mm_s2 = 6000
[[corner]]
name = "A"
angle_deg = 95
feed_in_mm_min = 6000
error_max_um = 50
"""
STUDY = """
title = "Tolerances"
task = "task.toml"
compute = ["optimum", "boxcar"]
[[vary]]
key = "corner.A.error_max_um"
name = "tolerance_um"
values = [20, 50, 80]
"""
SUITE = """
title = "Two solvers"
solvers = ["ipopt", "nlopt-slsqp"]
repeats = 1
time_limit_s = 2
[[problem]]
name = "acceleration"
family = "convex"
task = "task.toml"
formulation = "margin"
order = 20
"""


@pytest.fixture
def folder(tmp_path):
    for name, text in (("task", TASK), ("study", STUDY), ("suite", SUITE)):
        (tmp_path / f"{name}.toml").write_text(text)
    return tmp_path


def test_a_study_has_the_rows_of_the_program(folder):
    seen = []
    table = accdec.study(folder / "study.toml", progress=lambda *told: seen.append(told))
    assert len(seen) == 3 and seen[-1][:2] == (3, 3)
    assert table.attrs["summary"]["points"] == 3 and table.attrs["folder"] is None
    subprocess.run([os.environ["ACCDEC_BINARY"], "study", folder / "study.toml", "--out", folder / "out", "-q"],
                   check=True)
    pandas.testing.assert_frame_equal(table, pandas.read_csv(folder / "out" / "rows.csv"), check_flags=False)
    for _, row in table.iterrows():
        best = accdec.design(accdec.Task.parse(TASK).set("corner.A.error_max_um", row["tolerance_um"]))
        assert row["optimum.cycle_time_ms"] == pytest.approx(1e3 * best.fun, rel=1e-9)


def test_a_folder_keeps_the_results(folder):
    first = accdec.study(folder / "study.toml", out=folder / "kept")
    again = accdec.study(folder / "study.toml", out=folder / "kept")
    assert first.attrs["summary"]["computed"] == 3 and again.attrs["summary"]["computed"] == 0
    assert (folder / "kept" / "report.html").exists()
    pandas.testing.assert_frame_equal(first, again, check_flags=False)


def test_errors_are_those_of_the_program(folder):
    (folder / "study.toml").write_text(STUDY.replace("corner.A", "corner.B"))
    program = subprocess.run([os.environ["ACCDEC_BINARY"], "study", folder / "study.toml", "--out", folder / "out"],
                             capture_output=True, text=True)
    with pytest.raises(accdec.InputError) as raised:
        accdec.study(folder / "study.toml")
    assert str(raised.value) == program.stderr.strip() and raised.value.line > 0


def test_ctrl_c_ends_a_study_which_goes_on_later(folder):
    (folder / "study.toml").write_text(STUDY.replace("values = [20, 50, 80]",
                                                     "range = { from = 1, to = 200, count = 3000 }"))

    def interrupt(done, total, seconds):
        """Not after a fixed time: on a busy machine the study may not have begun by then."""
        if done:
            os.kill(os.getpid(), signal.SIGINT)

    with pytest.raises(KeyboardInterrupt):
        accdec.study(folder / "study.toml", out=folder / "long", progress=interrupt)
    assert list((folder / "long").glob("*.journal"))


def test_a_comparison_is_a_table_of_runs(folder):
    runs = accdec.compare(folder / "suite.toml")
    assert set(runs["solver"]) == {"ipopt", "nlopt-slsqp"} and len(runs) >= 2
    assert runs.attrs["summary"]["contradictions"] == 0
    assert set(accdec.compare(folder / "suite.toml", solvers=["ipopt"])["solver"]) == {"ipopt"}
