"""Everything that the wheel's module does, where nothing but Python and NumPy is installed."""
import pathlib

import accdec

task = accdec.Task(sample_period=1e-3, axes={"acceleration_max": 6.0},
                   corners={"angle_deg": 95, "feed_in": 0.1, "error_max": 50e-6})
result = accdec.design(task)
assert result.outcome == "optimal" and accdec.verify(result).accepted, result
names = [solver["name"] for solver in accdec._core.solvers()]  # accdec.solvers() needs pandas
assert {"ipopt", "nlopt-slsqp", "ceres-al"} <= set(names), names
for solver in ("ipopt", "nlopt-slsqp", "ceres-al"):
    # Ceres takes two seconds of processor time for it; the limit is for computers with much else to do.
    assert accdec.design(task, solver=solver, time_limit=300).success, solver
assert accdec.explain(task).gains and "taps" in accdec.export(result, "m")
assert "<svg" not in result._repr_html_()  # there is no gnuplot
square = pathlib.Path("square.ngc")
square.write_text("G21 G90 G64 P0.05\nG1 X20 F3000\nY20\nX0\nY0\nM2\n")
for plan in ("fixed", "profiles", "free"):
    made = accdec.program(square, {"sample_period": 1e-3, "axes": {"acceleration_max": 5.0}}, plan=plan, time_limit=60)
    assert made.success and "<html" in made.page(), plan
print("wheel", accdec.__version__, accdec.__file__, *names)
