"""A task without a design: why, and what would help."""
import subprocess

from opened import check


def empty(page):
    page.enter("#axis-0-acceleration_max_mm_s2", 0.001, "input")
    page.settle()
    check(page.value("document.body.classList.contains('failed')"),
          "no design: " + page.value("document.querySelector('#sentence').textContent")[:90])
    page.wait("document.querySelectorAll('#families tbody tr').length === 0", "no numbers of an older task")
    page.enter("#axis-0-acceleration_max_mm_s2", -5, "input")
    page.wait("document.querySelector('#trouble').textContent.includes('acceleration_max')",
              "the program's words for a wrong number")
    page.value("document.querySelector('#reset').click()")
    page.settle()
    check(not page.value("document.body.classList.contains('failed')"), "and back")


def plain(text):
    """Letters and signs as the command line has them, with single blanks."""
    for shown, printed in (("\u00b2", "^2"), ("\u00b3", "^3"), ("\u00b5m", "um"), ("\u2212", "-")):
        text = text.replace(shown, printed)
    return " ".join(text.split())


def same_advice(page):
    """What would make a design possible is said in the words of `accdec explain`."""
    # 100 mm/s at 1500 mm/s^2 and a period of 1 ms take 67 taps.
    page.value("""accdecPage.state.replace({ sample_period_ms: 1, axis: ["x", "y"].map((name) => ({ name,
        acceleration_max_mm_s2: 1500 })), design: { order_max: 40 },
        corner: [{ name: "A", angle_deg: 90, feed_in_mm_min: 6000, error_max_um: 50 }] })""")
    page.settle()
    page.value("document.querySelector('#explain').click()")
    page.wait("document.querySelector('#limits table')", "what would help", 60)
    file = page.home / "without.toml"
    file.write_text(page.task_file())
    said = subprocess.run([page.accdec, "explain", file], capture_output=True, text=True).stdout
    lines = [plain(line) for line in said.splitlines()]
    for text in page.value("[...document.querySelectorAll('#limits .wide p')].map((p) => p.textContent)"):
        check(plain(text) in lines, f"as accdec explain has it: {text[:70]}")
    rows = page.value("[...document.querySelectorAll('#limits tr')].map((r) => [...r.cells].map((c) => c.textContent))")
    for row in rows:
        check(plain(" ".join(row)) in lines, f"as accdec explain has it: {' '.join(row)}")
    at = lines.index(plain(" ".join(rows[0])))
    check(lines[at + len(rows)] == "", f"all {len(rows) - 1} rows of it")
    page.value("document.querySelector('#reset').click()")
    page.settle()
