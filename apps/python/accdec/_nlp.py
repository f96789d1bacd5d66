"""The nonlinear problems behind a design, for any optimiser."""

from __future__ import annotations

from typing import Any, Callable, Mapping, Optional, Sequence, Union

import numpy as np
import numpy.typing as npt

from . import _arguments as arguments
from . import _core
from ._design import TaskLike
from ._fields import as_task

Array = arguments.Array


class _Sparse:
    """A pattern of triplets as a CSR structure, made once; then only numbers are put in order."""

    def __init__(self, rows: npt.NDArray[np.int32], columns: npt.NDArray[np.int32], shape: tuple[int, int]) -> None:
        self.order = np.lexsort((columns, rows))
        self.indices = columns[self.order]
        self.indptr = np.searchsorted(rows[self.order], np.arange(shape[0] + 1))
        self.shape = shape

    def matrix(self, values: Array) -> Any:
        from scipy.sparse import csr_matrix
        return csr_matrix((values[self.order], self.indices, self.indptr), shape=self.shape)


class Problem:
    """A nonlinear problem: minimise fun(x) within bounds on x and on rows(x).

    `problem` makes it. Solvers written in Python also get one, and all their calls are counted.

    Attributes
    ----------
    name : str
    n, m : int
        Variables, rows.
    x0 : ndarray or None
        A start: a trapezoid with the delays that it needs. It is None within a solver, which gets its start separately.
    lb, ub, cl, cu : ndarray
        Bounds of variables and of rows; -inf or inf where there is none, equal for an equality.
    variable_names, row_names : list of str
    has_hessian : bool
    samples : list of int
        "margin": the sample of the blend at which each corner's error is bounded. Otherwise empty.

    Examples
    --------
    >>> import accdec
    >>> task = accdec.Task(sample_period=1e-3, axes={"acceleration_max": 6.0},
    ...                    corners={"angle_deg": 95, "feed_in": 0.1, "error_max": 50e-6})
    >>> p = accdec.problem(task, "margin", order=20, delays=[8])
    >>> p.jac(p.x0).shape == (p.m, p.n), p.check_derivatives(p.x0)
    (True, [])
    """

    def __init__(self, handle: _core.ProblemHandle, x0: Optional[Array] = None) -> None:
        self._handle = handle
        self.name = handle.name
        self.n, self.m = handle.n, handle.m
        self.has_hessian = handle.has_hessian
        self.linear = handle.linear
        self.lb, self.ub = handle.variable_bounds()
        self.cl, self.cu = handle.row_bounds()
        self.x0 = x0
        self.samples = handle.samples
        self._jacobian = _Sparse(*handle.jacobian_pattern(), shape=(self.m, self.n))
        self._hessian: Optional[_Sparse] = None
        if self.has_hessian:
            rows, columns = handle.hessian_pattern()
            self._off = rows != columns
            self._hessian = _Sparse(np.concatenate([rows, columns[self._off]]),
                                    np.concatenate([columns, rows[self._off]]), shape=(self.n, self.n))

    def __repr__(self) -> str:
        return f"<accdec.Problem {self.name}: {self.n} variables, {self.m} rows>"

    @property
    def variable_names(self) -> list[str]:
        return self._handle.variable_names()

    @property
    def row_names(self) -> list[str]:
        return self._handle.row_names()

    def fun(self, x: npt.ArrayLike) -> float:
        """The objective."""
        return self._handle.objective(arguments.array("x", x))

    def grad(self, x: npt.ArrayLike) -> Array:
        """Its gradient, dense."""
        return self._handle.gradient(arguments.array("x", x))

    def rows(self, x: npt.ArrayLike) -> Array:
        """The rows, to be held between `cl` and `cu`."""
        return self._handle.rows(arguments.array("x", x))

    def jac(self, x: npt.ArrayLike) -> Any:
        """The rows' Jacobian, a scipy.sparse.csr_matrix of m by n."""
        return self._jacobian.matrix(self._handle.jacobian(arguments.array("x", x)))

    def hess(self, x: npt.ArrayLike, multipliers: Optional[npt.ArrayLike] = None, factor: float = 1.0) -> Any:
        """The Hessian of factor * fun + multipliers . rows, a symmetric scipy.sparse.csr_matrix of n by n."""
        if self._hessian is None:
            raise ValueError("this form of the problem has no second derivatives; reduced=False has")
        y = np.zeros(self.m) if multipliers is None else arguments.array("multipliers", multipliers)
        lower = self._handle.hessian(arguments.array("x", x), arguments.real("factor", factor), y)
        return self._hessian.matrix(np.concatenate([lower, lower[self._off]]))

    def violation(self, x: npt.ArrayLike) -> float:
        """The largest absolute violation of any bound."""
        point, c = arguments.array("x", x), self.rows(x)
        parts = [self.lb - point, point - self.ub, self.cl - c, c - self.cu]
        return max(0.0, *(float(p.max()) for p in parts if p.size))

    @property
    def bounds(self) -> Any:
        """As scipy.optimize.Bounds."""
        from scipy.optimize import Bounds
        return Bounds(self.lb, self.ub)

    def constraints(self, dense: bool = False) -> list[Any]:
        """As scipy.optimize.NonlinearConstraint, for minimize; `dense` for methods that take no sparse Jacobian."""
        from scipy.optimize import BFGS, NonlinearConstraint

        def jac(x: Array) -> Any:
            return self.jac(x).toarray() if dense else self.jac(x)

        def hess(x: Array, v: Array) -> Any:
            return self.hess(x, v, factor=0.0)

        return [NonlinearConstraint(self.rows, self.cl, self.cu, jac=jac, hess=hess if self.has_hessian else BFGS())]

    def taps(self, x: npt.ArrayLike) -> Array:
        """The filter of a point, b_0 .. b_N, sum 1."""
        return self._handle.taps(arguments.array("x", x))

    def start(self, index: int, seed: int = 1) -> Array:
        """Another start: 0 is `x0`, others have every tap and free delay multiplied at random."""
        return self._handle.start(arguments.whole("index", index, 0, 10**6), arguments.seed(seed))

    def check_derivatives(self, x: npt.ArrayLike, tolerance: float = 1e-6) -> list[str]:
        """Entries of gradient, Jacobian and Hessian that differ from extrapolated central differences; best none.

        Second derivatives jump at x if an instant or a delay is a whole number of samples. The value of either side
        counts as right.
        """
        return self._handle.check_derivatives(arguments.array("x", x),
                                              arguments.number("tolerance", tolerance, "must be > 0", 1e-300, 1.0))


Function = Callable[[Problem, Array, Mapping[str, Any]], Any]


def problem(task: TaskLike, question: str = "delay", *, order: int, delays: Optional[Sequence[int]] = None,
            reduced: bool = False) -> Problem:
    """A nonlinear problem at a given order.

    Parameters
    ----------
    task : Task, path or dict
    question : {"delay", "margin"}
        "delay": the least weighted delay (samples), with continuous delays and instants of closest approach. "margin":
        the least (error/tolerance)^2 of the worst corner at given delays; it is at most 1 if the delays are possible.
    order : int
        N.
    delays : sequence of int, optional
        "margin": d_j (default 0). "delay": the delays at which limits on the blends are imposed.
    reduced : bool
        Substitute positions into their bounds: fewer variables, no equality rows, dense rows, no Hessian.

    Returns
    -------
    Problem

    Examples
    --------
    Any optimiser, here SciPy's:

    >>> import accdec, scipy.optimize
    >>> task = accdec.Task(sample_period=1e-3, axes={"acceleration_max": 6.0},
    ...                    corners={"angle_deg": 95, "feed_in": 0.1, "error_max": 50e-6})
    >>> p = accdec.problem(task, "margin", order=20, delays=[8], reduced=True)
    >>> found = scipy.optimize.minimize(p.fun, p.x0, jac=p.grad, method="SLSQP", bounds=p.bounds,
    ...                                 constraints=p.constraints(dense=True))
    >>> ours = accdec.solve(p, "ipopt")
    >>> found.success, ours.success, abs(found.fun - ours.fun) < 1e-5
    (True, True, True)
    """
    arguments.one_of("question", question, ("delay", "margin"))
    made = as_task(task)
    at = [] if delays is None else arguments.delays(delays, len(made.corners))
    handle = _core.make_problem(made, question, arguments.whole("order", order, 1, 100_000), at,
                                arguments.flag("reduced", reduced))
    return Problem(handle, handle.start(0, 1))


def _adapter(name: str, function: Function
             ) -> Callable[[_core.ProblemHandle, Array, Mapping[str, Any]], tuple[Array, bool, str]]:
    if not callable(function):
        raise arguments.wrong(name, "must be something to call", function, TypeError)

    def call(handle: _core.ProblemHandle, start: Array, options: Mapping[str, Any]) -> tuple[Array, bool, str]:
        answer = function(Problem(handle, start), start, options)
        if isinstance(answer, Mapping) or hasattr(answer, "x"):
            x, success = answer["x"], bool(answer.get("success", True))
            return np.asarray(x, dtype=float), success, str(answer.get("message", ""))
        return np.asarray(answer, dtype=float), True, ""
    return call


def solve(problem: Problem, solver: Union[str, Function] = "ipopt", *, x0: Optional[npt.ArrayLike] = None,
          tolerance: float = 1e-8, time_limit: float = 60.0, evaluation_limit: int = 1_000_000, seed: int = 1,
          options: Optional[Mapping[str, Any]] = None) -> Any:
    """Solve a problem by one of the library's solvers or by a function. The answer is recomputed and judged.

    Parameters
    ----------
    problem : Problem
    solver : str or callable
        A name of `solvers`, or a function(problem, start, options). It returns x, or an object with `x` (and
        `success`, `message`), as scipy.optimize does. Its calls are counted. The limits and Ctrl-C stop it.
    x0 : array_like, optional
        The default is the problem's own start.
    tolerance : float
        Relative tolerance set in the solver.
    time_limit : float
        s.
    evaluation_limit : int
        Largest number of evaluations of the objective.
    seed : int
    options : dict, optional
        The solver's own.

    Returns
    -------
    scipy.optimize.OptimizeResult
        `x`, `fun` and `maxcv` (largest violation) as recomputed; `success`: all bounds and rows hold to 1e-8 at x;
        `verdict` ("optimal": first-order optimal, "feasible", "infeasible", "none"); `claim`: what the solver said;
        `stationarity`, `multipliers`, `nfev`, `njev`, `ncev`, `ncjev`, `nhev`, `wall_time` (s), `history` of
        (evaluations, s, objective).

    Examples
    --------
    >>> import accdec
    >>> task = accdec.Task(sample_period=1e-3, axes={"acceleration_max": 6.0},
    ...                    corners={"angle_deg": 95, "feed_in": 0.1, "error_max": 50e-6})
    >>> p = accdec.problem(task, "delay", order=20)
    >>> accdec.solve(p).verdict
    'optimal'
    """
    from scipy.optimize import OptimizeResult
    if not isinstance(problem, Problem):
        raise arguments.wrong("problem", "must be a Problem", problem, TypeError)
    start = problem.x0 if x0 is None else arguments.array("x0", x0)
    if start is None:
        raise ValueError("x0: this problem has no start of its own")
    if start.shape != (problem.n,):
        raise ValueError(f"x0: {problem.n} numbers are needed, not {start.size}")
    answer = _core.solve(
        problem._handle, solver if isinstance(solver, str) else _adapter("solver", solver), start.tolist(),
        arguments.number("tolerance", tolerance, "must be > 0 and at most 1", 1e-300, 1.0),
        arguments.seconds("time_limit", time_limit),
        arguments.whole("evaluation_limit", evaluation_limit, 1, 10**18), arguments.seed(seed),
        arguments.native(options))
    success = answer["verdict"] in ("optimal", "feasible")
    status = 0 if answer["verdict"] == "optimal" else 1 if success else 4
    return OptimizeResult(success=success, status=status, **answer)


def solvers() -> Any:
    """The library's nonlinear and linear solvers.

    Returns
    -------
    pandas.DataFrame
        One row per solver: its name, version, what it accepts and what it uses.

    Examples
    --------
    >>> import accdec
    >>> bool(accdec.solvers()["name"].isin(["ipopt", "nlopt-slsqp"]).sum() == 2)
    True
    """
    import pandas
    return pandas.DataFrame(_core.solvers())


def register_solver(name: str, function: Function, *, equality_rows: bool = True) -> None:
    """Register a solver written in Python under a name, so that `design` and `solve` accept it.

    Parameters
    ----------
    name : str
        A name that no solver has yet.
    function : callable
        As in `solve`.
    equality_rows : bool
        Whether it accepts rows whose bounds are equal. Otherwise it gets the reduced form.

    Examples
    --------
    >>> import accdec, scipy.optimize
    >>> def slsqp(problem, start, options):
    ...     return scipy.optimize.minimize(problem.fun, start, jac=problem.grad, method="SLSQP", bounds=problem.bounds,
    ...                                    constraints=problem.constraints(dense=True), options={"maxiter": 200})
    >>> accdec.register_solver("scipy-slsqp", slsqp, equality_rows=False)
    >>> "scipy-slsqp" in accdec.solvers()["name"].tolist()
    True
    """
    if not arguments.text("name", name).strip():
        raise ValueError("name: must not be empty")
    _core.register_solver(name, _adapter("function", function), arguments.flag("equality_rows", equality_rows))
