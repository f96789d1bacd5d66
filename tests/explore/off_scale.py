"""What a drawing of a corner leaves out."""
import json

from opened import check

CORNER = {"name": "A", "feed_in_mm_min": 6000, "error_max_um": 100}  # 100 mm/s
AXES = [{"name": "x", "velocity_max_mm_s": 500, "acceleration_max_mm_s2": 1500},
        {"name": "y", "velocity_max_mm_s": 120, "acceleration_max_mm_s2": 1500}]


def show(page, axes, corner):
    task = {"sample_period_ms": 1, "axis": axes, "corner": [{**CORNER, **corner}]}
    page.value(f"accdecPage.state.replace({json.dumps(task)})")
    page.settle()


def off_scale(page):
    """Limits that are off the scale of a drawing are named in its title, those in the picture are not."""
    named = page.value("""import(location.pathname + 'curves.js').then((m) => [
        [[300, -300], [-10, 10]], [[300, -300], [-310, 310]], [[20, -25], [-22, 30]], [[], [0, 1]]].map(
            ([limits, range]) => m.offScale(limits.map((value) => ({ value })), range)))""")
    check(named == ["; limit \u00b1300, off scale", "", "; limit \u221225, off scale", ""], f"{named}")
    show(page, AXES, {"angle_deg": 90})
    titles = page.value("Object.fromEntries([...document.querySelectorAll('#motion section')].map((s) =>"
                        " [s.dataset.kind, s.querySelector('h2').textContent]))")
    check(titles["velocity"].endswith("; limit \u00b1500 of x, off scale"), titles["velocity"])
    check("off scale" not in titles["acceleration"], titles["acceleration"])
    show(page, [{**axis, "velocity_max_mm_s": 500} for axis in AXES], {"angle_deg": 90, "contour_max_um": 9000})
    title = page.value("document.querySelector('#motion [data-kind=velocity] h2').textContent")
    check(title.endswith("; limit \u00b1500, off scale"), f"without names where all axes have it: {title}")
    title = page.value("document.querySelector('#off h2').textContent")
    check(title.endswith("; limit 9000, off scale"), title)
    page.value("document.querySelector('#reset').click()")
    page.settle()


def no_motion(page):
    """A path back on itself along an axis is drawn as it is: nothing moves across it."""
    words = "[...document.querySelectorAll('#path svg text')].map((t) => t.textContent).join(' ')"
    show(page, AXES[:1], {"direction_in": [1], "direction_out": [-1], "error_max_um": 2000})
    page.wait("accdecPage.page.design.views[0]?.path.names", "the path")
    said = page.value(words)
    check("\u00b5m" in said and "times as long" not in said, f"a reversal: {said[-60:]}")
    show(page, AXES, {"angle_deg": 175, "error_max_um": 5})
    check("times as long" in page.value(words), "a flat corner is drawn longer on one axis")
    page.value("document.querySelector('#reset').click()")
    page.settle()
