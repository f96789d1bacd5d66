"""Controls of the page of a task: every key, offers, sliders over decades, fields without a number or a list."""
import json
import subprocess
import time

from opened import check


def every_key(page):
    schema = json.loads(
        subprocess.run([page.accdec, "schema", "task"], capture_output=True, text=True, check=True).stdout
    )
    for name in page.value("[...document.querySelectorAll('button.add')].map(b => b.textContent.slice(2))"):
        if name != "corner":  # every table that the task has not
            page.value(f"[...document.querySelectorAll('button.add')].find(b => b.textContent === '+ {name}').click()")
    page.value("[...document.querySelectorAll('button')].find(b => b.textContent === 'set them apart').click()")
    seen = set()
    kinds = schema["properties"]["filter"]["properties"]["kind"]["enum"]
    for kind in kinds:  # keys of one kind of filter only
        for table in ("filter", "baseline"):
            page.enter(f"#{table}-kind", kind, "change")
        seen |= set(page.value("""[...document.querySelectorAll('.row')].map(r => r.dataset.key).concat(
            [...document.querySelectorAll('select.more')].flatMap(s =>
                [...s.options].map(o => `${s.dataset.table}.${o.value}`)))"""))
    for name, table in schema["properties"].items():
        keys = (table.get("items") or table).get("properties") if table.get("type") in ("object", "array") else None
        missing = [k for k in keys or [name] if (f"{name}.{k}" if keys else name) not in seen]
        check(not missing, f"a control for every key of {name} {missing or ''}".strip())
    page.value("document.querySelector('#reset').click()")
    page.settle()


def offers(page):
    """A key that is offered can be added: what the task cannot have as it is stands in grey, with the reason."""
    shown = ("[...document.querySelectorAll('select.more')].flatMap((s, n) => [...s.options].slice(1)"
             ".map(o => [n, `${s.dataset.table}.${o.value}`, o.disabled, o.title]))")
    page.value("document.querySelector('#reset').click()")
    page.settle()
    page.wait(f"{shown}.some(o => o[2])", "some keys are offered in grey")
    time.sleep(0.3)
    for number, name, grey, why in page.value(shown):
        if grey:
            check(len(why) > 20, f"{name} is grey: {why[:70]}")
            continue
        page.value(f"(s => {{ s.value = '{name.split('.')[1]}'; s.nextElementSibling.click(); }})"
                   f"(document.querySelectorAll('select.more')[{number}])")
        page.settle()
        said = page.value("document.querySelector('#trouble').textContent")
        check(said == "" or said.startswith("No design:"), f"{name} can be added {said[:60]}")
        if name.endswith("direction_in"):
            corner = json.loads(page.value("document.body.dataset.task"))["corner"][0]
            check(len(corner["direction_in"]) == len(corner["direction_out"]) == 2 and "angle_deg" not in corner,
                  "a number for each axis")
        page.value("document.querySelector('#reset').click()")
        page.settle()


def tables(page):
    """A table that is added has all that it needs: the task is designed, or no filter holds its limits."""
    for name in page.value("[...document.querySelectorAll('button.add')].map(b => b.textContent)"):
        page.value(f"[...document.querySelectorAll('button.add')].find(b => b.textContent === '{name}').click()")
        page.settle()
        said = page.value("document.querySelector('#trouble').textContent")
        check(said == "" or said.startswith("No design:"), f"{name} can be added {said[:60]}")
        page.value("document.querySelector('#reset').click()")
        page.settle()


def decades(page):
    """A slider of a positive number goes over decades around its value, through round numbers, within the range."""
    slider = "document.querySelector('#sample_period_ms-slider')"
    first = float(page.value(f"{slider}.getAttribute('aria-valuetext')"))
    seen = page.value("""(r => { const seen = [], now = r.value;
        for (let i = 0; i <= r.max; ++i) {
            r.value = i; r.dispatchEvent(new Event('input')); seen.push(Number(r.getAttribute('aria-valuetext')));
        }
        r.value = now; r.dispatchEvent(new Event('input')); return seen; })(""" + slider + ")")
    low, high = 0.0001, 1000.0  # as the keys of a task say
    check(seen == sorted(set(seen)) and low <= seen[0] <= first / 9 and first * 9 <= seen[-1] <= high,
          f"{seen[0]} .. {seen[-1]} ms in {len(seen)} steps")
    check({0.5, 1, 2} <= set(seen), "0.5, 1 and 2 ms are among them")
    check(max(b / a for a, b in zip(seen, seen[1:])) < 1.03, "no step is larger than 3 %")
    page.value("document.querySelector('#reset').click()")
    page.settle()


def no_number(page):
    """A field without a number says what is allowed, and greys the answer; leaving it brings the last number back."""
    field = "document.querySelector('#corner-0-error_max_um')"
    shade = "getComputedStyle(document.querySelector('#badge')).backgroundColor"
    last, proved = page.value(f"{field}.value"), page.value(shade)
    page.value(f"(f => {{ f.focus(); f.value = ''; f.dispatchEvent(new Event('input')); }})({field})")
    said = page.value(f"{field}.parentElement.querySelector('[role=alert]').textContent")
    check("a number" in said and last in said, f"an empty field: {said}")
    check(page.value(shade) != proved
          and float(page.value("getComputedStyle(document.querySelector('#answer')).opacity")) < 1,
          "badge and numbers are grey")
    page.value(f"{field}.blur()")
    check(page.value(f"{field}.value") == last and page.value(shade) == proved,
          "the last number is back, and so is the badge")
    said = page.value(f"{field}.parentElement.querySelector('[role=alert]').textContent")
    check("is back" in said, said)


def comma(page):
    """A comma that is typed is a point; one that may divide thousands is refused in words."""
    field = "document.querySelector('#corner-0-error_max_um')"
    for typed, value in (("12,5", 12.5), ("1,25", 1.25), ("12.5", 12.5)):
        page.value(f"{field}.focus(), {field}.select()")
        for letter in typed:
            page.browser.page("Input.insertText", text=letter)
        check(page.value("accdecPage.state.task.corner[0].error_max_um") == value, f"{typed} typed is {value}")
    page.value(f"{field}.select()")
    page.browser.page("Input.insertText", text="1,250")
    said = page.value(f"{field}.parentElement.querySelector('[role=alert]').textContent")
    check("1,250 is not taken" in said and page.value("accdecPage.state.task.corner[0].error_max_um") == 12.5, said)
    page.value("document.querySelector('#reset').click()")
    page.settle()


def band(page):
    """The ends of a band stay in their order, by slider and by number."""
    page.value("accdecPage.state.set([[['mode'], [{ frequency_Hz: [18, 24], residual_max: 0.1 }]]], null, true)")
    page.settle()
    band = "accdecPage.state.task.mode[0].frequency_Hz"
    page.value("(r => { r.value = r.max; r.dispatchEvent(new Event('input')); })"
               "(document.querySelector('#mode-0-frequency_Hz-0-slider'))")
    check(page.value(band) == [24, 24], "the lower end stops at the upper one")
    page.enter("#mode-0-frequency_Hz-0", 20, "input")
    page.enter("#mode-0-frequency_Hz-1", 19, "input")
    said = page.value("document.querySelector('#mode-0-frequency_Hz-1').parentElement"
                      ".querySelector('[role=alert]').textContent")
    check("from 20" in said and page.value(band) == [20, 24], f"19 as the upper end: {said}")
    page.enter("#mode-0-frequency_Hz-1", 30, "input")
    check(page.value(band) == [20, 30], "30 is taken")
    page.value("document.querySelector('#reset').click()")
    page.settle()


def removals(page):
    """What can be removed leaves a task that the program takes."""
    tasks = [{"baseline": {"kind": "averages", "lengths": [40]}, "design": {"family": "averages", "stages": 2}},
             {"mode": [{"frequency_Hz": [18, 24], "residual_max": 0.1}]}]
    first = json.loads(page.value("document.body.dataset.task"))
    drops = "[...document.querySelectorAll('#controls .drop')].filter(b => !b.disabled).map(b => b.id)"
    for more in tasks:
        page.value(f"accdecPage.state.replace({json.dumps({**first, **more})})")
        page.settle()
        time.sleep(1.5)  # the page asks half a second after a change
        shown = page.value(drops)
        dead = {"corner-0-angle_deg-drop", "baseline-lengths-0-drop", "design-family-drop", "mode-0-residual_max-drop"}
        check(shown and not dead & set(shown), f"{len(shown)} keys can be removed, none of {sorted(dead)}")
        for drop in shown:
            page.value(f"document.querySelector('#{drop}').click()")
            task = json.loads(page.value("document.body.dataset.task"))
            refused = json.loads(page.program.post("check", [task])[1])[0]
            check(refused is None, f"{drop}: {refused or 'can be removed'}")
            page.value("document.querySelector('#undo').click()")
    page.value("document.querySelector('#reset').click()")
    page.settle()


def no_list(page):
    """A list without its bracket greys the answer and is not saved; a whole one is taken at once."""
    task = {**json.loads(page.value("document.body.dataset.task")), "controller": {"prefilter_taps": [0.1] * 10}}
    page.value(f"accdecPage.state.replace({json.dumps(task)})")
    page.settle()
    field = "document.querySelector('#controller-prefilter_taps')"
    state = (f"[document.body.classList.contains('unread'), {field}.validity.valid,"
             " accdecPage.state.task.controller.prefilter_taps]")
    page.enter("#controller-prefilter_taps", "[0.9, 0.1", "input")
    check(page.value(state) == [True, False, [0.1] * 10], "a list without its end greys the answer")
    said = page.value("accdecPage.pageText().then(() => 'saved', (error) => error.message)")
    check(said == "not saved: a field has no number that is allowed", said)
    page.enter("#controller-prefilter_taps", json.dumps([0.05] * 2 + [0.1] * 9), "input")
    check(page.value(state) == [False, True, [0.05] * 2 + [0.1] * 9], "a whole one is taken")
    page.value("document.querySelector('#reset').click()")
    page.settle()


def long_number(page):
    """A number with all digits of a double is seen whole in its field."""
    page.value("accdecPage.state.set([[['corner', 0, 'error_max_um'], 234.5678901234567]])")
    field = "document.querySelector('#corner-0-error_max_um')"
    shown = page.value(f"(f => [f.value, f.scrollWidth, f.clientWidth])({field})")
    check(shown[0] == "234.5678901234567" and shown[1] <= shown[2], f"{shown[0]} takes {shown[1]} of {shown[2]} px")
    page.value("document.querySelector('#reset').click()")
    page.settle()
