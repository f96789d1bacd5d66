"""The nonlinear problems: derivatives by differences, optima by SciPy and HiGHS, solvers written in Python."""
import os
import pathlib
import signal
import threading

import judge
import model
import numpy as np
import pytest
import scipy.optimize
import scipy.sparse

import accdec

CORNERS = pathlib.Path(__file__).parents[2] / "problems" / "corner"
FILE = {"sample_period_ms": 1.0,
        "axis": [{"acceleration_max_mm_s2": 6000, "jerk_max_mm_s3": 8e5, "mass_kg": 34, "damping_N_s_m": 60,
                  "force_max_N": 220}],
        "corner": [{"name": "A", "angle_deg": 80, "feed_in_mm_min": 5000, "feed_out_mm_min": 4500, "error_max_um": 60}]}
POWER = {**FILE, "axis": [{**FILE["axis"][0], "power_max_W": 14, "regeneration_max_W": 9}]}


def slsqp(problem, start, options):
    return scipy.optimize.minimize(problem.fun, start, jac=problem.grad, method="SLSQP", bounds=problem.bounds,
                                   constraints=problem.constraints(dense=True), options={"maxiter": 300, "ftol": 1e-10})


def problems():
    for task in (FILE, POWER):
        for question in ("margin", "delay"):
            for reduced in (False, True):
                yield accdec.problem(task, question, order=24, delays=[9], reduced=reduced)


@pytest.mark.parametrize("task", ["vibration-band", "force-friction"])
def test_derivatives_at_a_start_on_a_knot(task):
    """The start has a whole delay, where second derivatives of the interpolated response jump."""
    p = accdec.problem(CORNERS / f"{task}.toml", "delay", order=40 if task == "vibration-band" else 30)
    assert p.check_derivatives(p.x0) == []


@pytest.mark.parametrize("p", problems(), ids=repr)
def test_derivatives(p):
    dice = np.random.default_rng(4)
    x = p.x0 + 0.01 * dice.uniform(0.1, 1.0, p.n)
    y = dice.normal(size=p.m)
    step = 1e-6
    forward = [x + step * e for e in np.eye(p.n)]
    backward = [x - step * e for e in np.eye(p.n)]
    gradient = [(p.fun(a) - p.fun(b)) / (2 * step) for a, b in zip(forward, backward)]
    assert p.grad(x) == pytest.approx(gradient, rel=1e-6, abs=1e-6)
    jacobian = np.array([(p.rows(a) - p.rows(b)) / (2 * step) for a, b in zip(forward, backward)]).T
    assert scipy.sparse.isspmatrix_csr(p.jac(x)) and p.jac(x).has_sorted_indices
    assert p.jac(x).toarray() == pytest.approx(jacobian, rel=1e-5, abs=1e-5)
    assert p.check_derivatives(x) == []
    if not p.has_hessian:
        with pytest.raises(ValueError, match="second derivatives"):
            p.hess(x, y)
        return
    lagrangian = [((0.7 * p.grad(a) + p.jac(a).T @ y) - (0.7 * p.grad(b) + p.jac(b).T @ y)) / (2 * step)
                  for a, b in zip(forward, backward)]
    assert p.hess(x, y, factor=0.7).toarray() == pytest.approx(np.array(lagrangian), rel=1e-4, abs=1e-4)


def test_shapes_and_names():
    p = accdec.problem(FILE, "delay", order=24)
    assert p.x0.shape == p.lb.shape == p.ub.shape == p.grad(p.x0).shape == (p.n,)
    assert p.rows(p.x0).shape == p.cl.shape == p.cu.shape == (p.m,)
    assert len(set(p.variable_names)) == p.n and len(p.row_names) == p.m
    assert p.taps(p.x0) == pytest.approx(accdec.taps("trapezoid", 24, ramp=8), abs=1e-12)
    assert not np.array_equal(p.start(1), p.start(2)) and np.array_equal(p.start(1), p.start(1))
    with pytest.raises(ValueError, match="numbers are needed"):
        p.fun(p.x0[:-1])
    with pytest.raises(ValueError, match="question"):
        accdec.problem(FILE, "fastest", order=24)


@pytest.mark.parametrize("order, delay", [(27, 8), (24, 9), (30, 4)])
def test_the_least_error_is_that_of_slsqp_and_of_highs(order, delay):
    p = accdec.problem(FILE, "margin", order=order, delays=[delay], reduced=True)
    ours, theirs = accdec.solve(p, "ipopt"), accdec.solve(p, slsqp)
    assert ours.success and theirs.success
    assert ours.fun == pytest.approx(theirs.fun, rel=1e-5, abs=1e-7)
    corner = FILE["corner"][0]
    motion = model.unit_motions(FILE, corner, order, delay)
    position = [q[p.samples[0]] for q in motion.position]
    least = judge.smallest_error(model.linear_rows(FILE, corner, motion), [], position, np.inf)
    assert ours.fun == pytest.approx((least / 60e-6) ** 2, rel=1e-4, abs=1e-7)
    unbounded = {**FILE, "corner": [{**corner, "error_max_um": 1e9}]}
    assert model.worst_use(unbounded, p.taps(ours.x), [delay])[0] <= 1 + 1e-6


def test_the_least_delay_is_that_of_slsqp():
    p = accdec.problem(POWER, "delay", order=26, reduced=True)
    ours, theirs = accdec.solve(p, "ipopt"), accdec.solve(p, slsqp, x0=p.x0)
    assert ours.success and theirs.success
    assert ours.fun == pytest.approx(theirs.fun, rel=1e-5)
    full = accdec.solve(accdec.problem(POWER, "delay", order=26))
    assert full.fun == pytest.approx(ours.fun, rel=1e-5) and full.nhev > 0


def test_a_registered_solver_designs():
    accdec.register_solver("test-slsqp", slsqp, equality_rows=False)
    task = accdec.Task(**FILE)
    exact, design = accdec.design(task), accdec.design(task, solver="test-slsqp", time_limit=120)
    assert design.success and design.solver["name"] == "test-slsqp" and accdec.verify(design)
    assert exact.fun <= design.fun + 1e-12 <= exact.fun + 4e-3
    with pytest.raises(ValueError, match="exists already"):
        accdec.register_solver("test-slsqp", slsqp)


def test_nobodys_word_is_trusted():
    p = accdec.problem(FILE, "margin", order=20, delays=[0])
    lie = accdec.solve(p, lambda problem, start, options: {"x": start * 0 + 0.5, "success": True, "message": "great"})
    assert lie.claim == "solved" and lie.verdict == "infeasible" and not lie.success
    assert lie.maxcv == pytest.approx(p.violation(lie.x), rel=1e-12) and lie.maxcv > 1e-3


def test_what_goes_wrong_in_a_solver_comes_out():
    p = accdec.problem(FILE, "margin", order=20, delays=[5])
    with pytest.raises(ZeroDivisionError):
        accdec.solve(p, lambda problem, start, options: 1 / 0)
    with pytest.raises(ValueError, match="3 numbers"):
        accdec.solve(p, lambda problem, start, options: np.zeros(3))
    kept = []
    accdec.solve(p, lambda problem, start, options: kept.append(problem) or start)
    with pytest.raises(RuntimeError, match="over"):
        kept[0].fun(p.x0)


def endless(problem, start, options):
    while True:
        problem.fun(start)
        problem.rows(start)


def test_limits_end_a_solver():
    p = accdec.problem(FILE, "margin", order=20, delays=[20])
    timed = accdec.solve(p, endless, time_limit=0.2)
    assert timed.claim == "time limit" and timed.nfev > 0
    assert accdec.solve(p, endless, evaluation_limit=50).nfev == 50


def test_ctrl_c_ends_a_solver():
    p = accdec.problem(FILE, "margin", order=20, delays=[20])
    threading.Timer(0.3, os.kill, (os.getpid(), signal.SIGINT)).start()
    with pytest.raises(KeyboardInterrupt):
        accdec.solve(p, endless, time_limit=500)


def test_scipys_other_methods_take_the_sparse_form():
    p = accdec.problem(FILE, "margin", order=26, delays=[9])
    found = scipy.optimize.minimize(p.fun, p.x0, jac=p.grad, hess=lambda x: p.hess(x), method="trust-constr",
                                    bounds=p.bounds, constraints=p.constraints(), options={"maxiter": 300})
    assert found.fun == pytest.approx(accdec.solve(p).fun, rel=1e-2, abs=1e-3)
