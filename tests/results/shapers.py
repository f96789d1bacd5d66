"""What is recomputed of the pages of input shapers and kernels: `tests/bench/smooth_kernels.py`, `damped_shapers.py`."""
import sys


def kernels(page):
    sys.path.insert(0, str(page.source / "tests/bench"))
    try:
        import smooth_kernels
    except ImportError:  # numpy and scipy
        page.same("smooth_zv and others stand there", len(page.rows("kernel", "taps")), 3)
        return
    for name in ("smooth_zv", "smooth_mzv"):
        taps = smooth_kernels.taps_of(*smooth_kernels.KERNELS[name])
        step = max(abs(taps[0]), abs(taps[-1]), *abs(taps[1:] - taps[:-1]))
        allowed = smooth_kernels.residual(taps) * smooth_kernels.EXACT
        result, verified = smooth_kernels.shortest(page.program, taps.max(), step, allowed)
        row = page.row(page.rows("kernel", "taps"), "kernel", name)
        page.same(f"{name}, taps", row["taps"], str(len(taps)))
        page.same(f"{name}, shortest", row["shortest taps, undamped"], str(len(result["filter"]["taps"])))
        page.same(f"{name}, verified", str(verified), "True")


def damped_shapers(page):
    sys.path.insert(0, str(page.source / "tests/bench"))
    rows = page.rows("shaper", "its band, Hz")
    try:
        import damped_shapers
    except ImportError:  # numpy and scipy
        page.same("four shapers, the guard's four modes and three kernels stand there", len(rows), 11)
        return
    cases = {name: (damped_shapers.impulses()[name], damped_shapers.BAND) for name in ("ZV", "EI")}
    name = "guard 3: ZVDD"
    shaper, deviations = damped_shapers.GUARD[name]
    cases[name] = shaper, damped_shapers.band_of(deviations)
    own = " to ".join(f"{100 * part:+.1f}" for part in damped_shapers.deviations_of(*shaper)) + " %"
    page.same(f"{name}, deviations", own, page.row(page.rows("vibration guard"),
              "vibration guard", name)["of these impulses, at 5 %"])
    for name, (shaper, band) in cases.items():
        allowed = damped_shapers.worst_left(*shaper, band)
        result, verified = damped_shapers.shortest(page.program, None, None, allowed, band)
        row = page.row(rows, "shaper", name)
        page.same(f"{name}, shortest", row["shortest time, ms"],
                  f"{1e3 * damped_shapers.FINE * (len(result['filter']['taps']) - 1):.1f}")
        page.same(f"{name}, verified", str(verified), "True")


CHECKS = {"study/smooth-kernels/kernels.md": kernels, "study/smooth-kernels/damped.md": damped_shapers}
