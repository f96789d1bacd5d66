"""What the page says while it searches, and of a search that is cut off."""
from opened import check

# `searches`: whole is the search of the command line, else a shorter one; false: no answer comes.
WATCH = """globalThis.realFetch ??= fetch;
    globalThis.fetch = async (at, how) => {
        const question = String(at);
        if (!/^design/.test(question) || !/slot=(&|longer)/.test(question)) return realFetch(at, how);
        const change = (/whole/.test(question) ? whole : shorter);
        if (!change) return new Promise(() => {});
        const answer = await realFetch(at, how);
        return answer.status === 200 ? new Response(JSON.stringify(change(await answer.json()))) : answer;
    };"""
KEPT = "(answer) => answer"
NONE = """({ result: { filter, ...result }, ...answer }) => ({ ...answer, views: [],
    result: { ...result, status: "failed", stop: "time limit", message: "no taps in the time given", corners: [] } })"""
CUT = """({ result, ...answer }) => ({ ...answer, proof: { rechecked: false, text: "" },
    result: { ...result, status: "feasible", stop: "interrupted", lower_bound_s: undefined } })"""


def answers(page, whole, shorter):
    page.value(f"globalThis.whole = {whole}; globalThis.shorter = {shorter}; {WATCH}")


def step(page):
    page.value("document.querySelector('#corner-0-error_max_um-slider').focus()")
    page.key("ArrowLeft")


def again(page):
    page.value("globalThis.fetch = realFetch")
    page.open(page.program.address)
    page.settle()


def undone_soon(page):
    """A slow task that is changed and changed back before an answer has come is shown with its answer at once."""
    shown = page.value("document.querySelector('#time').dataset.value")
    answers(page, "null", KEPT)
    step(page)
    check(page.value("document.body.classList.contains('stale')"), "grey after a change")
    page.value("document.querySelector('#undo').click()")
    page.wait("!document.body.classList.contains('stale')", "undo within 0.3 s shows the answer of before", 2)
    page.wait("document.querySelector('#badge').textContent === 'proved'", "with its proof", 2)
    check(page.value("document.querySelector('#time').dataset.value") == shown, f"and its {shown} s")
    again(page)


def first_design(page):
    """While the first design is searched for, the page says so."""
    page.browser.open("about:blank")
    script = page.browser.page("Page.addScriptToEvaluateOnNewDocument", source="""const real = fetch;
        globalThis.fetch = (at, how) =>
            String(at).startsWith("design") ? new Promise(() => {}) : real(at, how);""")["identifier"]
    page.browser.open(page.program.address)
    page.wait("document.querySelectorAll('#families tbody tr').length > 3", "families before the first design")
    said = page.value("['#badge', '#sentence'].map((s) => document.querySelector(s).textContent)")
    check(said == ["searching", "No filter found so far: the search goes on."], f"before the first design: {said}")
    page.browser.page("Page.removeScriptToEvaluateOnNewDocument", identifier=script)
    page.open(page.program.address)
    page.settle()


def nothing_so_far(page):
    """A search without a filter so far has not failed: it goes on."""
    answers(page, "null", NONE)
    step(page)
    page.wait("document.querySelector('#badge').textContent === 'searching'", "the badge says that it searches")
    said = page.value("['#sentence', '#today', '#trouble'].map((s) => document.querySelector(s).textContent)")
    check(said[0].startswith("No filter found so far: the search goes on") and not said[2], f"{said}")
    check(not page.value("document.body.classList.contains('failed')"), "it has not failed")
    page.value("globalThis.fetch = realFetch")
    step(page)
    page.wait("document.querySelector('#badge').textContent === 'proved'", "the filter that is found at last")
    check(page.value("document.querySelector('#motion').getClientRects().length") > 0, "with its drawings")
    answers(page, NONE, NONE)
    step(page)
    page.wait("document.body.classList.contains('failed')", "a search that ended without a filter has failed")
    said = page.value("['#trouble', '#today'].map((s) => document.querySelector(s).textContent)")
    check("no taps in the time given" in said[0] and "cut off here after 60 s" in said[1], f"{said}")
    again(page)


def cut_off(page):
    """A search that is cut off may end with another filter on the command line: the page says so."""
    said = "document.querySelector('#today').textContent"
    check("cut off" not in page.value(said), "a search that ended is not cut off")
    answers(page, CUT, CUT)
    step(page)
    page.wait("document.querySelector('#badge').dataset.is === 'verified'", "not proved")
    page.wait(f"{said}.includes('accdec design was cut off here after 60 s')", "says that it was cut off")
    answers(page, "null", CUT)
    step(page)
    page.wait("document.querySelector('#badge').textContent === 'verified, searching on'", "searches on")
    check("cut off" not in page.value(said), "a search that goes on is not cut off")
    again(page)
