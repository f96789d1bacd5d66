"""Designs: what a result is, who judged it, and how a search is stopped."""
import os
import pickle
import random
import signal
import subprocess
import sys
import threading

import judge
import model
import numpy as np
import pytest
import tasks

import accdec


def everyday(**changes):
    fields = dict(sample_period=1e-3, axes={"acceleration_max": 6.0, "jerk_max": 500.0},
                  corners={"angle_deg": 95, "feed_in": 0.1, "error_max": 50e-6})
    return accdec.Task(**{**fields, **changes})


def hard():
    """Takes minutes: many corners that share a filter."""
    dice = np.random.default_rng(3)
    corners = [{"angle_deg": dice.uniform(35, 150), "feed_in": dice.uniform(0.06, 0.13), "weight": k + 1.0,
                "error_max": dice.uniform(10e-6, 150e-6)} for k in range(12)]
    return everyday(axes=[{"acceleration_max": 6.0, "jerk_max": 300.0}, {"acceleration_max": 5.0, "jerk_max": 250.0}],
                    modes={"frequency": [30, 34], "residual_max": 0.05}, corners=corners, sample_period=0.25e-3)


def test_result_is_like_scipys():
    result = accdec.design(everyday())
    assert result.success and result.status == 0 and result.outcome == "optimal"
    assert result.mip_gap == 0.0 and result.mip_dual_bound == pytest.approx(result.fun, rel=1e-9)
    assert result.fun == pytest.approx((result.order + 1 + result.delays[0]) * 1e-3, rel=1e-12)
    assert result.x.sum() == pytest.approx(1.0, abs=1e-12) and len(result.x) == result.order + 1
    assert dict(result)["fun"] == result["fun"] == result.fun
    assert "mip_gap" in result and "nonsense" not in result and len(list(result)) == len(result)
    assert "mip_gap" in repr(result) and "optimal" in str(result)
    assert result.certificate is not None and accdec.design(everyday(), certificate=False).certificate is None
    with pytest.raises(KeyError):
        result["nonsense"]


def test_settings_of_a_controller():
    task = everyday(family="averages", stages=2, length_step=1e-3, controller={"delays": ["in-position"]})
    result = accdec.design(task)
    assert result.outcome == "optimal" and result.family_bound == pytest.approx(result.fun, rel=1e-9)
    lengths = [round(value["value"]) for value in result.settings["values"]]
    assert [value["unit"] for value in result.settings["values"]] == ["ms", "ms"]
    taps = np.convolve(*(np.full(n, 1.0 / n) for n in lengths))
    assert np.allclose(result.x, taps, rtol=0, atol=1e-12)
    left = [0.1e-3 * sum(b * max(i - d, 0) for i, b in enumerate(taps)) for d in range(len(taps))]
    delay = next(d for d, way in enumerate(left) if way <= result.settings["width"])
    assert result.delays.tolist() == [delay] and result.settings["delays"] == ["in-position"]
    assert result.free_taps <= result.fun and result.mip_dual_bound <= result.free_taps * (1 + 1e-9)
    assert result.settings["answer"].startswith("Set these: averages of ") and accdec.verify(result).accepted
    assert pickle.loads(pickle.dumps(result)).settings == result.settings
    assert accdec.design(everyday()).settings is None
    waits = [everyday(family="averages", controller={"delays": ["in-position"], name: wait})
             for name, wait in (("in_position_latency", 2e-3), ("in_position_latency_ms", 2))]
    assert waits[0] == waits[1]
    with pytest.raises(accdec.InputError, match="no multiple of the sample period"):
        everyday(family="averages", length_step=1.5e-3)


def test_taps_are_a_read_only_view_of_the_result():
    result = accdec.design(everyday())
    assert result.x.base is result
    assert result.x.ctypes.data == result.x.ctypes.data == result.taps.ctypes.data
    assert not result.x.flags.writeable
    with pytest.raises(ValueError):
        result.x[0] = 1.0
    with pytest.raises(ValueError):
        result.x.flags.writeable = True
    view, copy = result.x, result.x.copy()
    del result
    assert np.array_equal(view, copy)


def test_results_go_and_come_back(tmp_path):
    result = accdec.design(everyday())
    result.write(tmp_path / "result.json")
    for again in (accdec.read_result(tmp_path / "result.json"), pickle.loads(pickle.dumps(result))):
        assert np.array_equal(again.x, result.x) and again.to_json() == result.to_json()
        assert accdec.verify(again)
    assert accdec.verify(tmp_path / "result.json").proof


def test_verify_rejects_a_forged_result():
    text = accdec.design(everyday()).to_json()
    forged = accdec.Result.parse(text.replace('"lower_bound_s": 0.042', '"lower_bound_s": 0.041'))
    check = accdec.verify(forged)
    assert not check and check.reasons


@pytest.mark.parametrize("seed", range(30))
def test_optima_stand_before_highs(seed):
    """Linear programs over every (N, d, k), solved by HiGHS, find nothing shorter, and find what is claimed."""
    task = tasks.draw(random.Random(1000 + seed), tasks.JUDGED[seed % len(tasks.JUDGED)], longest=9)
    result = accdec.design(accdec.Task(**task))
    if result.outcome == "infeasible":
        assert judge.exists(task, 60, order_min=30, order_max=30) is not True
        return
    assert result.outcome == "optimal"
    assert model.worst_use(task, result.x, result.delays)[0] <= 1.0 + 1e-7
    total = result.order + int(result.delays[0])
    assert judge.exists(task, total - 1) is not True
    assert judge.exists(task, total) is not False


def test_the_examples_of_the_docstrings_are_shortest():
    limits = {"acceleration_max_mm_s2": 6000}
    task = {"sample_period_ms": 1.0,
            "corner": [{"name": "A", "angle_deg": 95, "feed_in_mm_min": 6000, "error_max_um": 50}]}
    assert judge.exists({**task, "axis": [limits]}, 26) and not judge.exists({**task, "axis": [limits]}, 25)
    limits["jerk_max_mm_s3"] = 5e5
    assert judge.exists({**task, "axis": [limits]}, 41) and not judge.exists({**task, "axis": [limits]}, 40)


def test_given_filters_and_delays():
    task = everyday()
    boxcar = accdec.taps("boxcar", 19)
    result = accdec.evaluate(task, boxcar, [3])
    # Equal feeds, symmetric taps: eps = 2 v T cos(theta/2) E[max(i - N/2 - d/2, 0)], at a sample as N + d is even.
    closed = 2 * 0.1 * 1e-3 * np.cos(np.radians(95) / 2) * np.mean(np.maximum(np.arange(20) - 11.0, 0.0))
    assert result.corners[0]["corner_error"] == pytest.approx(closed, rel=1e-12)
    assert not result.success and result.outcome == "failed"  # a boxcar has no finite ramp of acceleration
    given = task.replace(filter=boxcar, axes={"acceleration_max": 6.0})
    found = accdec.design(given)
    assert found.delays[0] == accdec.smallest_delay(boxcar, np.radians(95), 0.1, 50e-6, sample_period=1e-3)
    with pytest.raises(ValueError, match="delays"):
        accdec.evaluate(given, boxcar)
    with pytest.raises(ValueError, match="delays: the task leaves a delay open"):
        accdec.evaluate(given)
    with pytest.raises(ValueError, match="taps: the task has no filter"):
        accdec.evaluate(task)
    with pytest.raises(accdec.InputError):
        accdec.design({"sample_period": 1e-3, "filter": [1.0]})


def test_other_methods():
    nlp = accdec.design(everyday(), solver="ipopt", time_limit=60)
    exact = accdec.design(everyday())
    assert nlp.success and nlp.status == 1 and nlp.mip_gap is None and nlp.solver["name"] == "ipopt"
    assert nlp.fun >= exact.fun - 1e-12
    with pytest.raises(ValueError, match="ipopt"):
        accdec.design(everyday(), solver="nonsense")
    with pytest.raises(ValueError, match="exclude"):
        accdec.design(everyday(), method="exact", solver="ipopt")
    with pytest.raises(ValueError, match="gap"):
        accdec.design(everyday(), gap=1.5)


def test_infeasible_is_a_result():
    result = accdec.design(everyday(order_max=3))
    assert not result.success and result.status == 2 and result.x is None and result.fun is None
    assert result.message


def test_progress_comes_in_the_calling_thread():
    seen = []
    accdec.design(everyday(), solver="ipopt", time_limit=60,
                  progress=lambda line: seen.append((line, threading.get_ident())))
    assert seen and {thread for _, thread in seen} == {threading.get_ident()}
    with pytest.raises(ZeroDivisionError):
        accdec.design(everyday(), solver="ipopt", time_limit=60, progress=lambda line: 1 / 0)


def test_ctrl_c_ends_a_search():
    threading.Timer(0.5, os.kill, (os.getpid(), signal.SIGINT)).start()
    with pytest.raises(KeyboardInterrupt):
        accdec.design(hard(), time_limit=500)


def test_other_threads_run_meanwhile():
    """Two designs in two threads, while a third counts: none waits for another to end."""
    ended = threading.Event()
    results = []

    def search():
        results.append(accdec.design(hard(), time_limit=1.5))
        ended.set()

    threads = [threading.Thread(target=search) for _ in range(2)]
    for thread in threads:
        thread.start()
    counted = 0
    while not ended.wait(0.01):
        counted += 1
    for thread in threads:
        thread.join()
    assert len(results) == 2 and counted > 10


@pytest.mark.parametrize("solver", ["nlopt-slsqp", None])
def test_a_script_ended_by_ctrl_c_ends_cleanly(solver):
    """The call returns at once; what a library still computes is waited for, and nothing crashes at exit."""
    script = ("import os, signal, threading, test_design as t, accdec\n"
              "threading.Timer(0.6, os.kill, (os.getpid(), signal.SIGINT)).start()\n"
              f"try: accdec.design(t.hard(), solver={solver!r}, time_limit=60)\n"
              "except KeyboardInterrupt: print('interrupted')\n")
    said = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, timeout=120)
    assert (said.returncode, said.stdout.strip(), said.stderr) == (0, "interrupted", "")


def test_whole_coefficients():
    """At most 12 of 256 units a tap, as a T/v = 0.05: 22 taps, of which the free optimum needs 20."""
    task = accdec.Task(sample_period=1e-3, axes={"acceleration_max": 5.0}, coefficient_bits=8,
                       corners={"direction_in": [1, 0], "direction_out": [0, 1], "feed_in": 0.1})
    result = accdec.design(task)
    assert result.order == 21
    assert sum(result.quantisation["coefficients"]) == 256
    assert np.array_equal(result.x * 256, result.quantisation["coefficients"])
    assert result.quantisation["unquantised"] == pytest.approx(0.020)
    assert accdec.verify(result)
    assert accdec.design(task.replace(coefficient_bits=None)).quantisation is None
    with pytest.raises(accdec.InputError, match="8 <= coefficient_bits <= 31"):
        task.replace(coefficient_bits=2)
