"""The page of a task by real keys: the focus stays, and arrow keys in a closed menu do nothing yet."""
import time

from opened import check

FOCUS = "document.activeElement.id || document.activeElement.textContent || document.activeElement.tagName"


def press(page, element, name, times=1):
    page.value(f"document.querySelector('{element}').focus()")
    for _ in range(times):
        page.key(name)


def keeps_focus(page):
    page.enter("#shipped", "three-corners", "change")
    page.settle()
    page.value("document.querySelectorAll('details').forEach(d => d.open = true)")
    names = page.value("[...document.querySelectorAll('#corners button')].map(b => b.textContent)")
    for element, wanted in (
        ("#axis-0-jerk_max_mm_s3-drop", "group-axis0"),
        ("#add-mode", "add-mode"),
        ("#remove-mode-0", "add-mode"),
        ("#add-baseline", "group-baseline"),
        ("#remove-baseline", "add-baseline"),
        ("#add-corner", "add-corner"),
        (f"#remove-corner-{len(names)}", "add-corner"),
        ("#corners button:nth-child(2)", names[1]),
        ("#explain", "explain"),
    ):
        press(page, element, "Enter")
        page.settle()
        found = page.value(FOCUS)
        check(found == wanted, f"Enter on {element}: the focus is at {found}, {wanted} is right")
    page.wait("document.querySelector('#limits table')", "the explanation", 60)
    check(page.value(FOCUS) == "explain", "the answer leaves the focus, too")
    closed_menus(page)
    end_of_slider(page)
    page.value("document.querySelector('#reset').click()")
    page.settle()
    menu_of_tasks(page)
    page.value("document.querySelector('#reset').click()")
    page.settle()


def menu_of_tasks(page):
    """Arrow keys walk through the menu of tasks; Enter or leaving it loads the one it is at."""
    task, name = "document.body.dataset.task", "document.querySelector('#shipped').value"
    for leave, times in (("Enter", 2), ("Tab", 1)):
        before = page.value(task)
        press(page, "#shipped", "ArrowDown", times)
        time.sleep(0.3)
        at = page.value(name)
        check(at and page.value(task) == before, f"arrow keys walk to {at}; nothing is loaded yet")
        page.key(leave)
        page.settle()
        wanted = page.value(f"JSON.stringify(accdecPage.start.shipped.find(s => s.name === '{at}').task)")
        check(page.value(task) == wanted and page.value(name) == at, f"{leave} loads {at}")


def end_of_slider(page):
    """Keys at the end of a slider change nothing, and leave nothing to undo."""
    press(page, "#corner-0-error_max_um-slider", "End")
    page.settle()
    past = "accdecPage.state.when = 0, accdecPage.state.history.past.length"  # no step of the last second to join
    before = page.value(past)
    for _ in range(2):
        page.key("ArrowRight", shift=True)
    check(page.value(past) == before, f"{before} steps to undo, no more")


def closed_menus(page):
    """Chromium goes to the next choice of a closed menu by an arrow key; a button acts on it."""
    task = "document.body.dataset.task"
    before = page.value(task)
    press(page, "#more-corner-0", "ArrowDown")
    chosen = page.value("document.querySelector('#more-corner-0').value")
    check(chosen and page.value(task) == before, f"arrow keys choose {chosen}; it is not added yet")
    press(page, "#more-corner-0-add", "Enter")
    page.settle()
    check(f'"{chosen}"' in page.value(task) and page.value(FOCUS) == "more-corner-0-add", "a button adds it")
    page.value("""globalThis.names = [], globalThis.realClick = HTMLAnchorElement.prototype.click;
        HTMLAnchorElement.prototype.click = function () { names.push(this.download); };""")
    press(page, "#export", "ArrowDown", times=2)
    time.sleep(0.3)
    check(page.value("names") == [], "arrow keys in the menu of exports download nothing")
    press(page, "#download", "Enter")
    page.wait("names.length", "a download")
    wanted = page.value("document.querySelector('#export').value")
    check(wanted not in ("task", "result") and page.value("names.length") == 1, f"the button does: {wanted}")
    page.value("HTMLAnchorElement.prototype.click = realClick")
