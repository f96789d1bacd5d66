"""Charts over time in a window of another width."""
import time

CHART = "document.querySelector('#over-time .draw')"
STATE = "[accdecProgram.shown.mark, document.activeElement === " + CHART + "]"


def press(browser, *keys):
    for key in keys:
        browser.value(f"{CHART}.dispatchEvent(new KeyboardEvent('keydown', {{ key: '{key}' }}))")
        time.sleep(0.1)


def resized(browser, check):
    """Cursor and focus stay when the window changes, and a cursor begins within what is shown of the time."""
    browser.value("document.activeElement.blur(), accdecProgram.state.set({ time: '' }),"
                  f" {CHART}.focus()")
    press(browser, "+", "+", "ArrowRight", "ArrowRight")
    before = browser.value(STATE)
    check(before[1] and before[0] > 0, f"the cursor over time is at sample {before[0]}")
    for wide in (800, 1200):
        browser.page("Emulation.setDeviceMetricsOverride", width=wide, height=1000, deviceScaleFactor=1, mobile=False)
        time.sleep(0.6)
        check(browser.value(STATE) == before, f"it stays there, with the focus, in a window of {wide} px")
        off = browser.value("accdecProgram.charts.filter((c) => Math.abs(c.width -"
                            " Math.max(260, c.root.parentElement.clientWidth)) > 1).length")
        check(off == 0, "and every chart is as wide as its place")
    for key in ("ArrowRight", "ArrowLeft", "Home", "End"):
        press(browser, key)
        inside = browser.value("(({ min, max }) => { const t = accdecProgram.program.plans[accdecProgram.shown.plan]"
                               ".t_s[accdecProgram.shown.mark]; return min - 1e-9 <= t && t <= max + 1e-9; })"
                               "(accdecProgram.charts[0].scales.x)")
        check(inside, f"{key} leaves the cursor within what is shown")
    press(browser, *["-"] * 4)


def no_empty_part(browser, check, what):
    """What is last in a row of drawings ends where the row ends. Charts of one row begin at one height."""
    ends = browser.value("""[...document.querySelectorAll(".two, .three")].filter((r) => r.getClientRects().length)
        .flatMap((row) => {
            const right = row.getBoundingClientRect().right, ends = new Map();
            for (const one of row.children) {
                const box = one.getBoundingClientRect();
                if (box.width) ends.set(Math.round(box.top), Math.max(ends.get(Math.round(box.top)) ?? 0, box.right));
            }
            return [...ends.values()].map((end) => right - end);
        })""")
    check(ends and max(ends) < 2, f"{what}: no part of {len(ends)} rows of drawings is empty")
    level = browser.value("""[...document.querySelectorAll(".three, #motion")].every((row) => {
            const tops = new Map();
            for (const one of row.querySelectorAll(".draw")) {
                const top = Math.round(one.parentElement.getBoundingClientRect().top);
                tops.set(top, new Set(tops.get(top)).add(Math.round(one.getBoundingClientRect().top)));
            }
            return [...tops.values()].every((heights) => heights.size === 1);
        })""")
    check(level, f"{what}: charts of one row are level")
