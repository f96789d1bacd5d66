"""Wrong arguments: each is named, with what is allowed; nothing of Python's or pybind11's own words comes through."""
import os
import signal
import threading
import time

import numpy as np
import pytest

import accdec

TASK = accdec.Task(sample_period=1e-3, axes={"acceleration_max": 6.0},
                   corners={"name": "A", "angle_deg": 95, "feed_in": 0.1, "error_max": 50e-6})
RESULT = accdec.design(TASK)
PROBLEM = accdec.problem(TASK, "margin", order=20, delays=[8])
SQUARE = "G21 G90 G64 P0.05\nG1 X20 F3000\nY20\nM2\n"
TAPS = np.full(10, 0.1)
CORNER = {"angle": 1.0, "feed_in": 0.1, "error_max": 1e-5, "sample_period": 1e-3}
inf, nan = np.inf, np.nan

# (call, what is right, {argument: wrong values})
CALLS = [
    (accdec.design, {"task": TASK}, {
        "method": ["simplex", 3], "solver": [5, "ipotp"], "time_limit": ["a", 0, -1.0, nan, inf, None, [1.0]],
        "gap": ["a", 1.0, -0.1, nan], "objective": [3, "fast"], "seed": [-1, 1.5, "a", 10**20],
        "threads": ["a", 0, -1, 2000, 1.5], "options": [3, "a", {"x": 1}], "certificate": ["yes", 1],
        "reduced": ["no"], "start": [TAPS], "progress": [3, "yes"], "task": [3, None]}),
    (accdec.design, {"task": TASK, "solver": "ipopt", "time_limit": 20}, {
        "start": ["a", [], [[0.5, 0.5]], [nan, 1.0], ["a"], np.ones(500)], "gap": [0.1],
        "options": [{"no_such": 1}]}),
    (accdec.design, {"task": TASK, "solver": "nlopt-isres", "time_limit": 20}, {"start": [TAPS]}),
    (accdec.evaluate, {"task": TASK, "taps": TAPS, "delays": [3]}, {
        "taps": ["a", ["a"], [], [[1.0]], [nan], [0.5, -0.5]], "delays": [["a"], "ab", 3, [1.7], [-1], [1, 2], [10**7]],
        "task": [3]}),
    (accdec.verify, {"result": RESULT}, {"time_limit": ["a", 0.0, nan], "result": [3, None]}),
    (accdec.read_result, {}, {"path": [3, None]}),
    (accdec.simulate, {"of": TASK, "taps": TAPS, "delay": 3}, {
        "corner": [5, -1, "B", 0.5, [0]], "taps": ["a", [[1.0]], [], [inf]],
        "delay": [1.7, -1, "a", 10**7, nan], "of": [3]}),
    (accdec.smallest_delay, {"taps": TAPS, **CORNER}, {
        "taps": ["a", [], [[1.0]], [nan]], "angle": ["a", 0.0, 4.0, nan, [1.0, 4.0]], "feed_in": ["a", -1.0, inf, nan],
        "feed_out": ["a", 0.0, nan], "error_max": ["a", -1e-6, nan],
        "sample_period": ["a", 0.0, -1e-3, inf, nan, None, [1e-3]]}),
    (accdec.residual_vibration, {"taps": TAPS, "frequency": [50.0], "sample_period": 1e-3}, {
        "taps": ["a", [nan]], "frequency": ["a", nan, [inf]], "sample_period": ["a", 0.0, -1e-3, inf, nan]}),
    (accdec.taps, {"kind": "boxcar", "order": 4}, {"kind": [3, "boxcer"], "order": ["a", -1, 1.5]}),
    (accdec.explain, {"task": TASK}, {"by": ["a", 0.0, 1.0, nan], "time_limit": ["a", 0], "task": [3],
                                      "design_time_limit": ["a", -1.0], "progress": [3]}),
    (accdec.baselines, {"task": TASK}, {"finer": ["a", 0, 1.5, 10**4], "time_limit": ["a", 0], "progress": ["x"]}),
    (accdec.problem, {"task": TASK, "order": 10}, {
        "question": [3, "design"], "order": ["a", 0, 1.5, 10**6], "delays": [["a"], 3, [1, 2], [0.5]],
        "reduced": ["a"]}),
    (accdec.solve, {"problem": PROBLEM}, {
        "problem": [3], "solver": [3, "ipotp"], "x0": ["a", [1.0]], "tolerance": ["a", 0.0, nan],
        "time_limit": ["a", 0.0], "evaluation_limit": ["a", 0, 1.5], "seed": [-1, "a"],
        "options": [3, {"no_such": 1}]}),
    (accdec.register_solver, {"name": "mine", "function": lambda p, x, o: x}, {
        "name": ["", " ", 3, "ipopt"], "function": [3, None, "f"], "equality_rows": ["a", 1]}),
    (accdec.plot, {"result": RESULT}, {"result": [3], "corner": [3, "B"], "path": [3]}),
    (accdec.export, {"result": RESULT, "format": "csv"}, {"result": [3], "format": [3, "cvs"], "path": [3]}),
    (accdec.study, {"path": "study.toml"}, {"path": [3, "no/such.toml"], "out": [3], "workers": ["a", -1, 1.5],
                                            "large": ["a"], "fresh": [2], "progress": [3]}),
    (accdec.compare, {"path": "suite.toml"}, {"path": [3, "no/such.toml"], "solvers": ["ipopt", 3, [3]], "out": [3],
                                              "workers": ["a"]}),
    (PROBLEM.fun, {}, {"x": ["a", [1.0]]}),
    (PROBLEM.jac, {}, {"x": ["a", [1.0]]}),
    (PROBLEM.hess, {"x": PROBLEM.x0}, {"x": ["a"], "multipliers": ["a", [1.0]], "factor": ["a"]}),
    (PROBLEM.start, {}, {"index": ["a", -1, 1.5]}),
    (PROBLEM.check_derivatives, {"x": PROBLEM.x0}, {"tolerance": ["a", 0.0]}),
    (TASK.set, {"key": "corner.A.error_max_um", "value": 20.0}, {"key": [3, "corner.A.eror_max_um"], "value": ["a"]}),
    (TASK.replace, {}, {"sample_period": ["a", -1.0, [1]], "axes": [3, "a", [3]], "corners": [3, "a"],
                        "order_max": ["a", 1.5], "objective": [3], "filter": [3, ["a"]], "runs": ["a"],
                        "axis": [{"acceleration_max": "a"}]}),
    (accdec.Task, {"sample_period": 1e-3, "corners": {"angle_deg": 90, "feed_in": 0.1}}, {"program": ["a", 3]}),
    (accdec.Task.read, {}, {"path": [3, "no/such.toml"]}),
    (accdec.Task.parse, {"text": TASK.to_toml()}, {"text": [3, "no toml"], "name": [3], "program": ["a"]}),
    (accdec.Result.parse, {"text": "{}"}, {"text": [3, "no json"]}),
]
FOREIGN = ["incompatible function arguments", "could not convert", "not supported between", "cast", "NoneType",
           "unexpected keyword", "object is not", "must be real number", "for int()", "operand", "has no attribute"]


def wrong_calls():
    for call, right, wrong in CALLS:
        for name, values in wrong.items():
            for value in values:
                yield pytest.param(call, right, name, value, id=f"{call.__name__}-{name}-{value!r:.20}")


@pytest.mark.parametrize("call, right, name, value", wrong_calls())
def test_names_what_is_wrong(call, right, name, value):
    with pytest.raises((ValueError, TypeError, OSError)) as refused:
        call(**{**right, name: value})
    said = str(refused.value)
    shown = {"of": "task"}.get(name, name)
    assert shown in said or not isinstance(value, (int, float)), said
    assert not [words for words in FOREIGN if words in said], said


@pytest.mark.parametrize("wrong, meant", [
    ({"axes": {"jerk": 1}}, "jerk_max"), ({"axes": {"force": 1}}, "force_max"), ({"axes": {"mas": 1}}, "mass"),
    ({"corners": {"angle_deg": 90, "feed_in": 0.1, "error": 1e-5}}, "error_max"), ({"machine": {"power": 1}},
                                                                                   "power_total_max"),
    ({"sample_perod": 1e-3}, "sample_period"), ({"corner_": {}}, "corners"), ({"ordermax": 9}, "order_max"),
    ({"length_stp": 2}, "length_step"), ({"modes": {"frequenc": 40}}, "frequency")])
def test_unknown_arguments_of_a_task_get_a_name_that_it_takes(wrong, meant):
    with pytest.raises(accdec.InputError, match=f"; did you mean `{meant}`\\?"):
        accdec.Task(**{"sample_period": 1e-3, "corners": {"angle_deg": 90, "feed_in": 0.1}, **wrong})
    with pytest.raises(accdec.InputError, match="`travel`; known are title, sample_period, axes, corners, modes"):
        TASK.replace(travel=1)


def test_program_names_what_is_wrong(tmp_path):
    file = tmp_path / "square.ngc"
    file.write_text(SQUARE)
    for name, values in {"plan": [3, "fast"], "feeds": [3], "arc_tolerance": ["a", 0.0, nan], "time_limit": ["a", 0.0],
                         "rapid_stops": ["a", 1], "compensate_arcs": [3], "tool_table": [3], "tool_length": ["a", 2e3],
                         "estimate": [3, "kliper", [3]],
                         "estimate_options": [3, {"resolution": "a"}, {"resolution": 1.0}],
                         "progress": [3], "file": [3, "no/such.ngc"]}.items():
        for value in values:
            with pytest.raises((ValueError, TypeError, OSError), match=name if name != "file" else "") as refused:
                accdec.program(**{"file": file, "task": {"sample_period": 1e-3}, name: value})
            assert not [words for words in FOREIGN if words in str(refused.value)], refused.value


def test_sizes_are_refused_before_memory_is_taken():
    with pytest.raises(ValueError, match="whole number from 0 to 1000000, got 2000000000"):
        accdec.simulate(TASK, taps=TAPS, delay=2_000_000_000)
    axes = [{"name": name} for name in "XYZABCUVW"]
    many = TASK.replace(axes=axes, corners={"direction_in": [1.0] + [0.0] * 8, "direction_out": [0.0, 1.0] + [0.0] * 7,
                                            "feed_in": 0.1})
    with pytest.raises(Exception, match="GB of memory"):
        accdec.simulate(many, taps=np.broadcast_to(1e-9, 60_000_000), delay=1)


def test_numbers_of_numpy_are_numbers():
    design = accdec.design(TASK, time_limit=np.float32(30), seed=np.uint8(3), threads=np.int64(1), gap=np.float64(0))
    assert design.outcome == "optimal"
    motion = accdec.simulate(TASK, taps=TAPS, delay=np.int16(3), corner=np.int8(0))
    assert (motion["velocity"] == accdec.simulate(TASK, taps=TAPS, delay=3.0)["velocity"]).all()


def test_a_start_is_used():
    """The same taps, found again at once: at another start the solver evaluates more often."""
    again = accdec.design(RESULT.task.replace(order_min=RESULT.order, order_max=RESULT.order), solver="nlopt-slsqp",
                          start=RESULT.x, time_limit=60)
    assert again.success and again.order == RESULT.order


class Interrupted:
    """Ctrl-C after `seconds`; how long the call went on after that."""

    def __init__(self, seconds):
        self.timer = threading.Timer(seconds, self.interrupt)

    def interrupt(self):
        self.sent = time.monotonic()
        os.kill(os.getpid(), signal.SIGINT)

    def __enter__(self):
        self.timer.start()
        return self

    def __exit__(self, kind, error, trace):
        self.late = time.monotonic() - self.sent
        return kind is KeyboardInterrupt


@pytest.mark.parametrize("name", ["simulate", "smallest_delay", "residual_vibration", "evaluate"])
def test_ctrl_c_ends_what_lasts(name):
    """Without it each would last for at least ten times as long as it may."""
    taps = np.full(400_000, 1 / 400_000)
    angle = np.random.default_rng(1).uniform(0.2, 3.0, 30_000_000) if name == "smallest_delay" else None
    calls = {
        "simulate": lambda: accdec.simulate(TASK, taps=taps, delay=1_000_000),
        "smallest_delay": lambda: accdec.smallest_delay(TAPS, angle, 0.1, 1e-6, sample_period=1e-3),
        "residual_vibration": lambda: accdec.residual_vibration(taps, np.linspace(0, 500, 100_000), 1e-3),
        "evaluate": lambda: accdec.evaluate(TASK, taps, [1_000_000]),
    }
    with Interrupted(0.3) as interrupted:
        end = time.monotonic() + 20
        while time.monotonic() < end:
            calls[name]()
        pytest.fail("it was not interrupted")
    print(f"{name}: {interrupted.late:.3f} s")
