"""A headless Chromium driven through its debugging pipe, with the standard library alone."""
import json
import os
import signal
import subprocess


class Browser:
    def __init__(self, program, profile):
        # The browser reads commands from its descriptor 3 and writes answers to 4, each ended by a zero byte.
        commands, self.out = os.pipe()
        self.into, answers = os.pipe()

        def place():
            a, b = os.dup(commands), os.dup(answers)
            os.dup2(a, 3)
            os.dup2(b, 4)

        self.process = subprocess.Popen(
            [program, "--headless=new", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage", "--no-first-run",
             "--disable-background-networking", f"--user-data-dir={profile}", "--remote-debugging-pipe", "about:blank"],
            preexec_fn=place, close_fds=False, start_new_session=True, stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL)
        os.close(commands)
        os.close(answers)
        self.number, self.buffer, self.events = 0, b"", []
        self.target = self.call("Target.createTarget", url="about:blank")["targetId"]
        self.session = self.call("Target.attachToTarget", targetId=self.target, flatten=True)["sessionId"]
        for domain in ("Page", "Runtime", "Log", "Network"):
            self.page(f"{domain}.enable")

    def receive(self):
        while b"\0" not in self.buffer:
            part = os.read(self.into, 1 << 20)
            if not part:
                raise RuntimeError("the browser ended")
            self.buffer += part
        message, _, self.buffer = self.buffer.partition(b"\0")
        return json.loads(message)

    def call(self, method, session=None, **parameters):
        self.number += 1
        message = {"id": self.number, "method": method, "params": parameters}
        if session:
            message["sessionId"] = session
        os.write(self.out, json.dumps(message).encode() + b"\0")
        while True:
            answer = self.receive()
            if answer.get("id") == self.number:
                if "error" in answer:
                    raise RuntimeError(f"{method}: {answer['error']}")
                return answer["result"]
            self.events.append(answer)

    def page(self, method, **parameters):
        return self.call(method, self.session, **parameters)

    def value(self, expression):
        result = self.page("Runtime.evaluate", expression=expression, returnByValue=True, awaitPromise=True)
        if "exceptionDetails" in result:
            raise RuntimeError(f"{expression}: {result['exceptionDetails']}")
        return result["result"].get("value")

    def open(self, path):
        """A file, or an address."""
        self.events.clear()
        self.page("Page.navigate", url=f"file://{path}" if str(path).startswith("/") else path)
        while not any(e.get("method") == "Page.loadEventFired" for e in self.events):
            self.events.append(self.receive())
        self.value("1")  # whatever the page's script had to say is here now

    def watch_canvases(self):
        """From the next page on, `cut` lists the texts that are drawn beyond the edge of their canvas."""
        self.page("Page.addScriptToEvaluateOnNewDocument", source="""globalThis.cut = [];
            const fill = CanvasRenderingContext2D.prototype.fillText;
            CanvasRenderingContext2D.prototype.fillText = function (text, x, y, ...rest) {
              const box = this.measureText(text), { width, height } = this.canvas;
              for (const dx of [-box.actualBoundingBoxLeft, box.actualBoundingBoxRight]) {
                const at = this.getTransform().transformPoint(new DOMPoint(x + dx, y));
                if (at.x < -0.5 || at.x > width + 0.5 || at.y < 0 || at.y > height) cut.push(text);
              }
              return fill.call(this, text, x, y, ...rest);
            };""")

    def sideways(self):
        """What would have to be moved sideways to be seen."""
        return self.value("[...document.querySelectorAll('body *')].filter(e => e.clientWidth && e.scrollWidth > e.clientWidth + 1 &&"
                          " !['visible', 'clip'].includes(getComputedStyle(e).overflowX) && !e.matches('input, select'))"
                          ".map(e => `${e.tagName}#${e.id} in ${e.parentElement.id}: ${e.scrollWidth} of ${e.clientWidth}`)")

    def complaints(self):
        """Errors on the console, exceptions, and requests for anything but the page itself."""
        found = []
        for e in self.events:
            method, p = e.get("method"), e.get("params", {})
            if method == "Runtime.exceptionThrown":
                found.append(p["exceptionDetails"].get("text"))
            elif method == "Runtime.consoleAPICalled" and p["type"] in ("error", "warning"):
                found.append(str(p["args"]))
            elif method == "Log.entryAdded" and p["entry"]["level"] in ("error", "warning"):
                found.append(p["entry"]["text"])
            elif method == "Network.requestWillBeSent" and p["type"] != "Document":
                found.append(f"request for {p['request']['url']}")
        return found

    def close(self):
        """Ends it with all its processes. One that is left would still write to the folder that is deleted next."""
        try:
            self.call("Browser.close")
            self.process.wait(10)
        except (OSError, RuntimeError, subprocess.TimeoutExpired):
            os.killpg(self.process.pid, signal.SIGKILL)
            self.process.wait()
