"""The page of a task on paper."""
import time

from opened import check


def paper(page):
    """Nothing is folded, cut, empty or too small to be read."""
    b = page.browser
    b.page("Emulation.setDeviceMetricsOverride", width=1400, height=900, deviceScaleFactor=1, mobile=False)
    page.open(page.program.address)
    title = "a title that is longer than the field in which it stands, as titles of tasks often are"
    page.enter("#title", title, "change")
    page.settle()
    page.wait("!accdecPage.awaited().length", "all answers")
    folded = "document.querySelectorAll('details:not([open])').length"
    before = page.value(folded)
    b.page("Emulation.setEmulatedMedia", media="print")
    fields = "[...document.querySelectorAll('details[open] > .row input[type=text]')]"
    hidden = page.value(f"{fields}.filter((f) => !f.getClientRects().length).map((f) => f.id)")
    check(page.value(f"{fields}.length") > 0 and not hidden,
          f"fields are on paper where a browser does not tell that it prints {hidden or ''}".strip())
    page.value("dispatchEvent(new Event('beforeprint'))")
    b.page("Emulation.setDeviceMetricsOverride", width=718, height=1000, deviceScaleFactor=1, mobile=False)
    time.sleep(0.4)
    small = page.value("Math.min(...[...document.querySelectorAll('.draw > svg text')].map(t =>"
                       " parseFloat(getComputedStyle(t).fontSize) * t.getScreenCTM().a))")
    check(small >= 10, f"words in the path's drawing are {small:.1f} px high on paper")
    check(page.value(folded) == 0 < before, f"{before} folded parts are open on paper")
    taps = page.value("[document.querySelectorAll('#tap-table tbody tr').length,"
                      " accdecPage.page.design.result.filter.taps.length]")
    check(taps[0] == taps[1] > 0, f"with all {taps[0]} taps")
    wide = page.value("document.documentElement.scrollWidth")
    check(wide <= 718, f"nothing is wider than the paper ({wide} px)")
    both = page.value("[...document.querySelectorAll('#controls input[type=text]')].filter((f) =>"
                      " f.getClientRects().length).length")
    check(both == 0, "no value is there twice")
    shown = page.value("[...document.querySelectorAll('#controls output')].filter(o => o.getClientRects().length)"
                       ".map(o => [o.textContent, o.scrollWidth <= o.clientWidth + 1])")
    check([title, True] in shown and all(whole for _, whole in shown), "texts of fields are whole")
    badge = page.value("(({color, backgroundColor: ground}) => [color, ground])("
                       "getComputedStyle(document.querySelector('#badge[data-is=proved]')))")
    check(badge[1] == "rgba(0, 0, 0, 0)" and badge[0] not in ("rgb(255, 255, 255)", badge[1]),
          "a proof's badge needs no background to be read")
    empty = page.value("[...document.querySelectorAll('h2')].filter(h => h.getClientRects().length &&"
                       " h.parentElement.getBoundingClientRect().bottom - h.getBoundingClientRect().bottom < 5)"
                       ".map(h => h.textContent)")
    check(not empty, f"no heading without anything below {empty or ''}".strip())
    b.page("Emulation.setEmulatedMedia", media="")
    b.page("Emulation.setDeviceMetricsOverride", width=1400, height=900, deviceScaleFactor=1, mobile=False)
    page.value("dispatchEvent(new Event('afterprint'))")
    check(page.value(folded) == before and page.value("document.querySelectorAll('#controls output').length") == 0,
          "and all is as before")
