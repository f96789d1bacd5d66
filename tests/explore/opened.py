"""The page of a task in a browser: what it shows, and that the numbers are those of the command line."""
import json
import statistics
import subprocess
import sys
import time

from program import Program


def check(holds, what):
    if not holds:
        sys.exit(f"explore page test: {what}")
    print(f"ok: {what}", flush=True)


class Page:
    def __init__(self, accdec, browser, home, task):
        self.accdec, self.browser, self.home = accdec, browser, home
        self.program = Program(accdec, task, cwd=home)
        self.value = browser.value
        self.open(self.program.address)

    def open(self, address):
        self.browser.open("about:blank")
        self.browser.open(address)
        self.wait("document.body.classList.contains('ready')", "the page is ready")

    def wait(self, condition, what, seconds=20):
        until = time.monotonic() + seconds
        while not self.value(f"!!({condition})"):
            if time.monotonic() > until:
                shown = self.value("['#limits', 'header'].map((s) => document.querySelector(s)?.innerText).join(' | ')")
                sys.exit(f"explore page test: not within {seconds} s: {what}; {shown}")
            time.sleep(0.02)

    def settle(self):
        time.sleep(0.1)
        self.wait("!document.body.classList.contains('stale')", "the answer is there")
        time.sleep(0.1)

    def enter(self, selector, value, event):
        """A value in a field or menu, with the event by which its control notices."""
        self.value(f"(f => {{ f.value = {json.dumps(value)}; f.dispatchEvent(new Event('{event}')); }})"
                   f"(document.querySelector('{selector}'))")

    def key(self, name, shift=False):
        code = {"ArrowLeft": 37, "ArrowRight": 39, "ArrowDown": 40, "End": 35, "Enter": 13, "Tab": 9, "z": 90}[name]
        for kind in ("keyDown", "keyUp"):
            text = {"text": "\r"} if name == "Enter" and kind == "keyDown" else {}
            self.browser.page("Input.dispatchKeyEvent", type=kind, key=name, code=name, windowsVirtualKeyCode=code,
                              modifiers=8 * shift, **text)

    def task_file(self):
        """What `copy as task file` gives."""
        return self.value("import(location.pathname + 'requests.js').then(async (m) => m.askText('file', "
                          "JSON.parse(document.body.dataset.task)))")

    def same_as_program(self, what):
        """The page's numbers are those of the command line on the page's task file."""
        file = self.home / "page.toml"
        file.write_text(self.task_file())
        out = self.home / "result.json"
        said = subprocess.run(
            [self.accdec, "design", file, "--json", out], check=True, capture_output=True, text=True
        ).stdout
        result = json.loads(out.read_text())
        shown = self.value("Number(document.querySelector('#time').dataset.value)")
        check(shown == result["cycle_time_s"], f"{what}: {shown} s, as accdec design --json has it")
        if "savings" in result:
            saved = self.value("Number(document.querySelector('#saved').dataset.value)")
            check(saved == result["savings"]["total_s"], f"{what}: {saved} s saved, as accdec design --json has it")
        table = self.value("[...document.querySelectorAll('#corner-table tbody tr')].map(r => r.cells[1].textContent)")
        check(table == [str(c["delay_samples"]) for c in result["corners"]], f"{what}: delays {table}")
        rows = self.value(
            "[...document.querySelectorAll('#corner-table tbody tr')].map(r => [...r.cells].map(c => c.textContent))"
        )
        lines = [" ".join(line.split()) for line in said.splitlines()]
        check(
            all(" ".join(row) in lines for row in rows), f"{what}: corners as the command line prints them, {rows[0]}"
        )
        return result

    def latency(self, name, steps=20):
        """ms from a change to the picture, of the families and of the proved design, as a line."""
        self.wait("!document.querySelector('#beside').textContent.includes('nothing')", "a filter to compare with")
        self.value("globalThis.accdecLatency = {}")
        for i in range(steps):
            self.value(
                f"(r => {{ r.value = Number(r.value) + {3 if i % 4 < 2 else -3}; r.dispatchEvent(new Event('input'));"
                " })(document.querySelector('[id$=error_max_um-slider], [id$=feed_in_mm_min-slider]'))"
            )
            self.settle()
            time.sleep(0.1)
        found = self.value("globalThis.accdecLatency")
        median = {what: statistics.median(times) for what, times in found.items()}
        return (f"{name}: families {median.get('families', 0):.0f} ms, proved design {median.get('design', 0):.0f} ms "
                f"(medians of {steps})")
