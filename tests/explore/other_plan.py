"""The page of a program, where the pointer stands on the time of one plan: numbers of the plan in grey."""
import csv
import math
import subprocess
import time

from looking import check


def samples(accdec, home, program, task):
    """By plan: every sample of it as the command line writes it, speed in mm/s by its number."""
    speeds = {}
    for plan in ("fixed", "profiles"):
        out = home / f"{plan}.csv"
        subprocess.run([accdec, "--quiet", "program", program, "--task", task, "--plan", plan, "--samples", out],
                       check=True)
        head, *rows = csv.reader(out.read_text().splitlines())
        ways = [i for i, name in enumerate(head) if name.endswith("_s") and name != "time_s"]
        speeds[plan] = [math.hypot(*(float(row[i]) for i in ways)) for row in rows]
    return speeds


def other_plan(browser, speeds, period=1e-3):
    """The number in grey is the other plan's at the time that is shown, or its own time stands beside it."""
    shown = browser.value("accdecProgram.program.plans.length")
    browser.value(f"document.querySelectorAll('#plans button')[{shown - 1}].click()")
    row = "[...document.querySelector('#over-time .u-legend').rows].map(r => [...r.cells].map(c => c.textContent))"
    for share in (0.031, 0.1, 0.3333, 0.517, 0.7, 0.9, 0.97):
        place = browser.value(f"(r => [r.left + r.width * {share}, r.top + r.height / 2])"
                              "(document.querySelector('#over-time .u-over').getBoundingClientRect())")
        browser.page("Input.dispatchMouseEvent", type="mouseMoved", x=place[0], y=place[1])
        time.sleep(0.1)
        (_, t), *plans = browser.value(row)
        for name, text in plans:
            if name not in speeds:
                continue  # how far plan free comes depends on the time it had
            said, _, own = text.removesuffix(" s").partition(" at ")
            k = round(float(own or t) / period)
            at = speeds[name][k] if k < len(speeds[name]) else 0.0
            check(abs(float(said) - at) <= 6e-4 * at + 1e-4, f"plan {name} at {own or t} s: {said} of {at:.4f} mm/s")
        # The plan in colour has a sample at the time that is shown. The one in grey may have none if both are steady.
        check(any(" at " not in text for _, text in plans), f"one number is of {t} s")
    browser.value("document.querySelectorAll('#plans button')[0].click()")
