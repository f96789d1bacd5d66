"""Parameter studies and comparisons of solvers, as tables of pandas."""

from __future__ import annotations

import builtins
import json
import os
import pathlib
import subprocess
import sys
import tempfile
from typing import Any, Callable, Optional, Sequence, Union

from . import _arguments as arguments
from . import _core

Path = Union[str, "os.PathLike[str]"]
Progress = Union[bool, Callable[[int, int, float], object], None]


def _print_progress(done: int, total: int, seconds: float) -> None:
    print(f"\r{done} of {total}, {seconds:.0f} s", end="\n" if done == total else "", flush=True)


def _raise(message: dict[str, Any]) -> None:
    name = message["error"]
    known: Any = getattr(_core, name, None) or getattr(builtins, name, None) or RuntimeError
    error = known(message["text"])
    for attribute, value in message["attributes"].items():
        setattr(error, attribute, value)
    raise error


def _run(call: str, options: dict[str, Any], progress: Progress) -> dict[str, Any]:
    """In a child of its own, which ends with this call, however that ends."""
    tell = arguments.listener(progress, _print_progress)
    folder = str(pathlib.Path(_core.__file__).parent)
    request = json.dumps({"call": call, "arguments": options, "folder": folder})
    worker = str(pathlib.Path(__file__).with_name("_worker.py"))
    answer = None
    with subprocess.Popen([sys.executable, worker, request], stdout=subprocess.PIPE, text=True) as child:
        assert child.stdout is not None
        try:
            for line in child.stdout:
                message = json.loads(line)
                if "error" in message:
                    _raise(message)
                if "answer" in message:
                    answer = message["answer"]
                elif tell:
                    tell(*message["progress"])
        except BaseException:
            child.kill()
            raise
    if answer is None:
        raise RuntimeError(f"the process that computed died with {child.returncode}; what it journaled is kept in "
                           f"{options['out']}: run this again to go on")
    return answer


def _table(path: Path, call: str, options: dict[str, Any], out: Optional[Path], file: str, progress: Progress,
           verb: str) -> Any:
    import pandas
    with tempfile.TemporaryDirectory(prefix="accdec-") as scratch:
        folder = os.path.join(scratch, "results") if out is None else arguments.path("out", out)
        command = f"accdec.{verb}({arguments.path('path', path)!r}" + (")" if out is None else f", out={folder!r})")
        summary = _run(call, {"path": os.fspath(path), "out": folder, "command": command, **options}, progress)
        table = pandas.read_csv(os.path.join(folder, file))
    table.attrs["summary"] = summary
    table.attrs["folder"] = None if out is None else folder
    return table


def study(path: Path, *, out: Optional[Path] = None, workers: int = 0, large: bool = False, fresh: bool = False,
          progress: Progress = None) -> Any:
    """Run a parameter study.

    Parameters
    ----------
    path : path
        STUDY.toml: base task, what varies, what to compute.
    out : path, optional
        Folder for rows, figures and report. An interrupted study continues there. Without it only the table is kept.
    workers : int
        Points computed at a time; 0: all cores.
    large : bool
        Allow more than 100 000 points.
    fresh : bool
        Compute all points again, even those in the folder.
    progress : bool or callable, optional
        True shows it; a callable gets (done, total, seconds).

    Returns
    -------
    pandas.DataFrame
        One row per point, columns as in rows.csv (their names have the units). ``attrs["summary"]`` counts points.

    Raises
    ------
    InputError, OutputError
        With the text of the command line.

    Notes
    -----
    The study runs in its own process. Ctrl-C ends it at once; with `out` the next call continues it.

    Examples
    --------
    >>> import accdec, pathlib, tempfile
    >>> folder = pathlib.Path(tempfile.mkdtemp())
    >>> accdec.Task(sample_period=1e-3, axes={"acceleration_max": 6.0}, corners={"name": "A", "angle_deg": 95,
    ...             "feed_in": 0.1, "error_max": 50e-6}).write(folder / "task.toml")
    >>> _ = (folder / "study.toml").write_text('''
    ... title = "Tolerances"
    ... task = "task.toml"
    ... compute = ["optimum"]
    ... [[vary]]
    ... key = "corner.A.error_max_um"
    ... name = "tolerance_um"
    ... values = [20, 50]
    ... ''')
    >>> accdec.study(folder / "study.toml")[["tolerance_um", "optimum.status", "optimum.cycle_time_ms"]]
       tolerance_um optimum.status  optimum.cycle_time_ms
    0          20.0        optimal                   30.0
    1          50.0        optimal                   27.0
    """
    options = {"workers": arguments.whole("workers", workers, 0, 1024), "large": arguments.flag("large", large),
               "fresh": arguments.flag("fresh", fresh)}
    return _table(path, "run_study", options, out, "rows.csv", progress, "study")


def compare(path: Path, *, solvers: Sequence[str] = (), out: Optional[Path] = None, workers: int = 0,
            progress: Progress = None) -> Any:
    """Compare solvers on a suite of problems, every answer verified.

    Parameters
    ----------
    path : path
        SUITE.toml: problems, solvers, limits.
    solvers : sequence of str, optional
        Solvers instead of the suite's.
    out : path, optional
        Folder for raw data, tables, figures and report. An interrupted comparison continues there.
    workers : int
        Runs at a time; 0: all cores.
    progress : bool or callable, optional
        True shows it; a callable gets (done, total, seconds).

    Returns
    -------
    pandas.DataFrame
        One row per run, as in runs.csv.

    Raises
    ------
    InputError, OutputError
        With the text of the command line.

    Examples
    --------
    >>> import accdec, pathlib, tempfile
    >>> folder = pathlib.Path(tempfile.mkdtemp())
    >>> accdec.Task(sample_period=1e-3, axes={"acceleration_max": 6.0}, corners={"angle_deg": 95, "feed_in": 0.1,
    ...             "error_max": 50e-6}).write(folder / "task.toml")
    >>> _ = (folder / "suite.toml").write_text('''
    ... title = "Two solvers"
    ... solvers = ["ipopt", "nlopt-slsqp"]
    ... repeats = 1
    ... time_limit_s = 2
    ... [[problem]]
    ... name = "acceleration"
    ... family = "convex"
    ... task = "task.toml"
    ... formulation = "margin"
    ... order = 20
    ... ''')
    >>> sorted(set(accdec.compare(folder / "suite.toml")["solver"]))
    ['ipopt', 'nlopt-slsqp']
    """
    if isinstance(solvers, str) or not isinstance(solvers, Sequence):
        raise arguments.wrong("solvers", "must be a list of names", solvers, TypeError)
    options = {"workers": arguments.whole("workers", workers, 0, 1024),
               "solvers": [arguments.text("solvers", name) for name in solvers]}
    return _table(path, "run_comparison", options, out, "runs.csv", progress, "compare")
