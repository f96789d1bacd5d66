"""A corner of a program's page by itself: by a click, from the list, from the address, in the saved page."""
import json
import math
import time

from looking import check, wait
from program import Program


def click_near(browser, corner):
    """Presses the pointer where a corner is drawn."""
    browser.value("document.querySelector('#path canvas').scrollIntoView()")
    place = browser.value("((r, p) => [r.left + p[0], r.top + p[1]])"
                          "(document.querySelector('#path canvas').getBoundingClientRect(),"
                          f" accdecProgram.scene.at({corner}.at_mm))")
    for kind in ("mousePressed", "mouseReleased"):
        browser.page("Input.dispatchMouseEvent", type=kind, x=place[0], y=place[1], button="left", clickCount=1)


def planned_feeds(browser, fixed):
    """Corners are opened at the feeds of the blocks that meet there, as the result of plan fixed has them."""
    commands, size = fixed["commands"], len(fixed["commands"]["axes"])
    points = [commands["points_m"][i:i + size] for i in range(0, len(commands["points_m"]), size)]
    feeds = [6e4 * math.dist(*points[b:b + 2]) / t for b, t in enumerate(commands["duration_s"])]
    corners = browser.value("accdecProgram.program.corners")
    off, slower = 0.0, 0
    for c in corners:
        ends = [b for b, line in enumerate(commands["line"][:-1])
                if line == c["line"] and math.dist(points[b + 1], [x / 1e3 for x in c["at_mm"]]) < 1e-7]
        asked = [c["corner"]["feed_in_mm_min"], c["corner"]["feed_out_mm_min"]]
        off = max(off, min(max(abs(asked[i] - feeds[b + i]) for i in (0, 1)) for b in ends))
        slower += c["planned"] and asked[0] < 0.999 * c["programmed_mm_min"][0]
    check(off <= 1.1e-3, f"corners have the feeds of plan fixed, within {off:.1g} mm/min")  # rounded down to 0.001
    check(slower > 0, f"{slower} of {len(corners)} corners are slower than programmed")


def today_holds(program, browser):
    """What holds in the program holds at its corners, or the page says why not."""
    start = browser.value("accdecProgram.program")
    base = {**start["base"], "filter": start["base"]["baseline"]}
    del base["baseline"]
    rapid = [c["corner"] for c in start["corners"] if max(c["programmed_mm_min"]) > 10000]
    for corner in rapid[:4]:
        answer = json.loads(program.post("design", {**base, "corner": [corner]}, format="given")[1])["result"]
        check("filter" in answer, f"today's filter holds at {corner['name']}, {corner['feed_in_mm_min']} mm/min")


def without_corner(accdec, browser, home, task):
    """A line, and arcs that go on in one direction, are shown like any program."""
    for name, moves in (("line", "G1 X50"), ("arcs", "G2 X20 Y0 I10 J0\nG3 X40 Y0 I10 J0")):
        code = home / f"{name}.ngc"
        code.write_text(f"G21 G90 G17 G64 P0.05 F3000\n{moves}\nM2\n")
        program = Program(accdec, code, "--task", task, cwd=home)
        browser.open(program.address)
        wait(browser, "document.body.classList.contains('ready')", f"a page of {name}")
        said = browser.value("document.querySelector('#corner-list').textContent")
        check("no corner to open" in said and browser.value("accdecProgram.program.plans.length") == 2, f"{name}: {said}")
        browser.open("about:blank")
        program.end()


def enters(browser):
    """Enter opens the corner nearest to the cursor, on the path and in the charts; without a cursor that in the middle."""
    opened = "accdecProgram.state.now.corner"
    middle = browser.value("""(({ program, scene }) => {
        const middle = [scene.canvas.clientWidth / 2, scene.canvas.clientHeight / 2];
        const drawn = program.corners.map(c => Math.hypot(...scene.at(c.at_mm).map((x, a) => x - middle[a])));
        return [Math.min(...drawn), drawn]; })(accdecProgram)""")
    enter = "document.querySelector('{}').dispatchEvent(new KeyboardEvent('keydown', {{ key: 'Enter', bubbles: true }}))"
    browser.value(enter.format("#path canvas"))
    check(middle[1][int(browser.value(opened))] == middle[0], "without a cursor: the corner in the middle")
    for n in range(12):
        # In one step: drawing again, at whatever time, may move the cursor or take it away.
        found, far = browser.value(f"""(({{ program, charts, scene }}) => {{
            const plan = program.plans[0], i = Math.floor({n + 0.5} * plan.t_s.length / 12);
            charts[0].setCursor({{ left: charts[0].valToPos(plan.t_s[i], 'x'), top: 9 }});
            const {{ mark }} = scene;
            {enter.format("#over-time .draw" if n % 2 else "#path canvas")};
            const far = program.corners.map(c => Math.hypot(...c.at_mm.map((x, a) => x - plan.places_mm[a][mark])));
            return [far[{opened}], far]; }})(accdecProgram)""")
        check(abs(found - min(far)) < 1e-9, f"Enter opens the corner {found:.4g} mm from the cursor, none is nearer")
    browser.value("accdecProgram.state.set({ corner: '' })")


def lists_all(browser):
    """Every corner of the program has a link, which keys reach."""
    count = browser.value("accdecProgram.program.corners.length")
    links = "document.querySelectorAll('#corner-list a')"
    check(browser.value(f"{links}.length") == 20 < count, f"the sharpest 20 of {count} at first")
    browser.value("document.querySelector('#corner-list button').click()")
    lines = browser.value(f"[...{links}].map(a => Number(a.textContent.split(' ')[1])).sort((a, b) => a - b)")
    check(lines == browser.value("accdecProgram.program.corners.map(c => c.line)"), f"all {len(lines)} by a button")
    check(browser.value(f"document.activeElement === {links}[20]"), "the focus goes to the first new one")


def stops_exactly(accdec, home, task):
    """A corner where the program stops, by G61.1 or by a dwell, is one without an error."""
    code = home / "stops.ngc"
    code.write_text("G21 G90 F3000 G61.1\nG1 X20\nG64 P0.05 Y20\nG1 X40\nG4 P0.1\nY40\nG64 P0.03 X60\nY60\nM2\n")
    program = Program(accdec, code, "--task", task, cwd=home)
    start = json.loads(program.ask("GET", program.path + "start")[1])["program"]
    found = {c["line"]: (c["stop"], c["corner"].get("error_max_um")) for c in start["corners"]}
    check(found == {2: (True, 0), 3: (False, 50), 4: (True, 0), 6: (False, 50), 7: (False, 30)},
          f"exact stops are corners without an error: {found}")
    exact = next(c["corner"] for c in start["corners"] if c["line"] == 2)
    answer = json.loads(program.post("design", {**start["base"], "corner": [exact]})[1])
    check(answer["exact_stop"] and answer["result"]["corners"][0]["corner_error_m"] < 1e-9, "and designed as such")
    program.end()


def opens(browser, home):
    """A click near a corner opens the explorer with that corner above the path, and a design of it."""
    within = "document.querySelector('#corner iframe')?.contentWindow"
    ready = f"{within}?.document.body?.classList.contains('ready')"
    heading = "document.querySelector('#corner h2').textContent"
    check(browser.value("document.querySelector('#corner').hidden"), "no corner is open at first")
    click_near(browser, "accdecProgram.program.corners.at(-1)")
    wait(browser, ready, "a click near a corner opens it")
    foot = browser.value("document.querySelector('#corner').getBoundingClientRect().bottom")
    path = browser.value("document.querySelector('#path').getBoundingClientRect().top")
    check(foot <= path, f"above the path: down to {foot:.0f} px, the path is from {path:.0f} px on")
    first = json.loads(browser.value(f"{within}.document.body.dataset.task"))
    # Several corners may be drawn at one place.
    near = browser.value("""(({ corners }, place) => corners.filter(c => place(c.at_mm).join() === place(corners.at(-1)
        .at_mm).join()).map(c => c.corner))(accdecProgram.program, p => accdecProgram.scene.at(p).map(Math.round))""")
    wanted = first["corner"][0]
    check(len(first["corner"]) == 1 and wanted in near, f"the corner {wanted['name']} as a task, of {len(near)} there")
    check(len(first["axis"]) >= 2, "with all axes")
    check(browser.value(f"Number({within}.document.querySelector('#time').dataset.value)") > 0, "and its design")
    check(wanted["name"][1:] in browser.value(heading).split(), browser.value(heading))
    saved = browser.value("accdecProgram.pageText()")
    check("<script" not in saved and "&lt;script" not in saved, "saved as one file, with the corner in it")
    browser.value("document.querySelector('#corner-list a').click()")
    wait(browser, f"{ready} && JSON.parse({within}.document.body.dataset.task).corner[0].name !== '{wanted['name']}'",
         "another one from the list, in its place")
    check(browser.value("document.querySelectorAll('iframe').length") == 1, "one at a time")
    time.sleep(0.4)
    address = browser.value("location.href")
    for word, corner in (("undo", wanted["name"]), ("undo", None), ("redo", wanted["name"])):
        browser.value(f"document.querySelector('#{word}').click()")
        if corner is None:
            check(browser.value("document.querySelector('#corner').hidden"), f"{word} closes it")
        else:
            wait(browser, f"{ready} && {heading}.split(' ').includes('{corner[1:]}')", f"{word}: {corner}")
    browser.value("document.querySelector('#corner button').click()")
    check(browser.value("document.querySelector('#corner').hidden"), "it can be closed")
    browser.open("about:blank")
    browser.open(address)
    wait(browser, ready, "the address opens it")
    for wide in (390, 1200):
        browser.page(
            "Emulation.setDeviceMetricsOverride", width=wide, height=800, deviceScaleFactor=1, mobile=wide < 400
        )
        wait(browser, f"document.documentElement.scrollWidth <= {wide}", f"fits {wide} px")
        wait(browser, f"(d => d.scrollWidth <= d.clientWidth)({within}.document.documentElement)",
             "so does the corner's page")
    alone = browser.value("document.querySelector('#corner a').href")
    (home / "corner.html").write_text(saved)
    browser.open("about:blank")
    browser.open(home / "corner.html")
    wait(browser, f"Number({within}.document.querySelector('#time').dataset.value) > 0",
         "the saved page shows its design")
    wrong = [c for c in browser.complaints() if "data:" not in c]
    check(not wrong, f"and asks for nothing {wrong or ''}".strip())
    browser.open(alone)
    wait(browser, "document.body.classList.contains('ready')", "a window of its own")
