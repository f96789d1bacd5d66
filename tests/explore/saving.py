"""The page saved as one file."""
import json
import re

from opened import check


def saves_one_task(page):
    """A page saved while answers are under way waits for them; without an answer it is not saved."""
    page.wait("document.querySelectorAll('#families tbody tr').length > 3", "families")
    before = page.value("document.querySelector('#time').dataset.value")
    page.value("""globalThis.realFetch = fetch;
        globalThis.fetch = async (at, how) => {
            if (/^(design|families)/.test(at)) await new Promise((go) => setTimeout(go, 6000));
            return realFetch(at, how);
        };""")
    page.value("document.querySelector('#corner-0-error_max_um-slider').focus()")
    for _ in range(3):
        page.key("ArrowLeft", shift=True)
    text = page.value("accdecPage.pageText({ tell: (what) => (globalThis.told ??= what) })")
    check(page.value("told").startswith("waiting for the"), page.value("told"))
    shown = page.value("document.querySelector('#time').dataset.value")
    check(shown != before and f'data-value="{shown}"' in text, f"saved while it searched: {shown} s, not {before} s")
    bound = json.loads(page.value("document.body.dataset.task"))["corner"][0]["error_max_um"]
    check(f"error_max_um = {bound}" in text, f"with the task of that time, {bound} um")
    check(not re.search(r'class="[^"]*\b(stale|old)\b', text), "and no row of another task")
    page.value("globalThis.fetch = (at, how) =>"
               " String(at).startsWith('design') ? new Promise(() => {}) : realFetch(at, how)")
    page.key("ArrowLeft", shift=True)
    for wanted in ("waiting for the design", "not saved: these numbers have no answer yet"):
        page.value("document.querySelector('#save').click()")
        page.wait(f"document.querySelector('#note').textContent.startsWith({json.dumps(wanted)})", wanted)
    page.value("globalThis.fetch = realFetch")
    page.open(page.program.address)
    page.settle()


def searches_on(page):
    """A proof that was not rechecked in a moment is looked for again; the page says so, and is saved with its end."""
    page.value("""globalThis.realFetch = fetch;
        globalThis.fetch = async (at, how) => {
            if (/slot=longer/.test(at)) await new Promise((go) => setTimeout(go, 1500));
            const answer = await realFetch(at, how);
            if (!/^design.*slot=&/.test(at) || answer.status !== 200) return answer;
            const said = await answer.json();
            return new Response(JSON.stringify({ ...said, proof: { rechecked: false, text: "no time" } }));
        };""")
    page.value("document.querySelector('#corner-0-error_max_um-slider').focus()")
    page.key("ArrowLeft")
    badge = "document.querySelector('#badge')"
    page.wait(f"{badge}.textContent === 'best, searching on'", "it says that it searches on")
    text = page.value("accdecPage.pageText()")
    check(page.value(f"{badge}.textContent") == "proved" and ">proved<" in text, "then it is proved, also where saved")
    page.value("globalThis.fetch = realFetch")
    page.open(page.program.address)
    page.settle()


def saves(page):
    page.browser.events.clear()
    text = page.value("accdecPage.pageText()")
    page.value("document.querySelector('#save').click()")
    page.settle()
    wrong = [c for c in page.browser.complaints() if not c.startswith("request for")]
    check(not wrong, f"saves without a word on the console {wrong or ''}".strip())
    file = page.home / "saved.html"
    file.write_text(text)
    check(not [dead for dead in ("find out<", 'id="whole"', "from rest to rest</label") if dead in text],
          "no control that does nothing")
    check("<script" not in text and "<link" not in text and "src=\"http" not in text,
          f"saved as one file of {len(text) / 1e3:.0f} kB")
    address = page.value("location.href")
    page.browser.open("about:blank")  # what the old page still asks is not the saved page's
    page.browser.open(file)
    wrong = [c for c in page.browser.complaints() if "data:" not in c]
    check(not wrong, f"the saved page asks for nothing {wrong or ''}".strip())
    check("ms" in page.value("document.querySelector('#time').textContent"), "and shows the design")
    page.open(address)


def exports_one_task(page):
    """Taps are exported as the page shows them: an answer under way is waited for, a field without a number refused."""
    page.value("""globalThis.realFetch = fetch, globalThis.realAddress = URL.createObjectURL, globalThis.files = [];
        URL.createObjectURL = (blob) => (files.push(blob.text()), "data:,");
        globalThis.fetch = async (at, how) => {
            if (/^design/.test(at)) await new Promise((go) => setTimeout(go, 700));
            return realFetch(at, how);
        };""")
    field = "document.querySelector('#corner-0-error_max_um')"
    page.value(f"{field}.value = 5, {field}.dispatchEvent(new Event('input'))")
    page.value("document.querySelector('#export').value = 'csv', document.querySelector('#download').click()")
    page.wait("files.length", "the taps")
    rows = [line.split(",") for line in page.value("files.pop()").splitlines()]
    found = [float(row[1]) for row in rows if row[0].isdigit()]
    task, taps = page.value("[accdecPage.page.design.of, accdecPage.page.design.result.filter.taps]")
    check(json.loads(task)["corner"][0]["error_max_um"] == 5 and found == taps, f"{len(taps)} taps for 5 um, as shown")
    page.value(f"{field}.value = 6, {field}.dispatchEvent(new Event('input'))")
    for name in ("q15", "m"):
        page.value(f"document.querySelector('#export').value = '{name}', document.querySelector('#download').click()")
    page.wait("files.length === 2", "two files asked for while an answer is under way")
    page.value("files.length = 0")
    page.value(f"{field}.focus(), {field}.value = '', {field}.dispatchEvent(new Event('input'))")
    for name in ("csv", "task", "result"):
        page.value("document.querySelector('#note').textContent = '';"
                   f"document.querySelector('#export').value = '{name}', document.querySelector('#download').click()")
        page.wait("document.querySelector('#note').textContent.startsWith('not saved')", f"no {name} of an empty field")
    check(page.value("files.length") == 0, "and no file")
    page.value("globalThis.fetch = realFetch, URL.createObjectURL = realAddress")
    page.value("document.querySelector('#reset').click()")
    page.settle()
