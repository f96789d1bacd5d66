"""The browser is opened by the desktop's `xdg-open`, here a script, without a word that other users could ask with."""
import os
import pathlib
import re
import signal
import stat
import subprocess
import tempfile
import time


def by_desktop(check, accdec, task):
    with tempfile.TemporaryDirectory() as folder:
        home = pathlib.Path(folder)
        temporary = home / "tmp"
        temporary.mkdir()
        opener, seen = home / "xdg-open", home / "seen"
        for code in (0, 3):
            opener.write_text(f"#!/bin/sh\nprintf '%s' \"$1\" > {seen}.new; mv {seen}.new {seen}; exit {code}\n")
            opener.chmod(0o755)
            seen.unlink(missing_ok=True)
            place = {**os.environ, "PATH": f"{home}:{os.environ['PATH']}", "TMPDIR": str(temporary)}
            process = subprocess.Popen([accdec, "explore", task], env=place, cwd=home, stdout=subprocess.PIPE,
                                       stderr=subprocess.PIPE, text=True)
            address, said = process.stdout.readline().strip(), process.stdout.readline()
            until = time.monotonic() + 10
            while not seen.exists() and time.monotonic() < until:
                time.sleep(0.05)
            words = seen.read_text()
            token = re.fullmatch(r"http://127.0.0.1:\d+/([0-9a-f]{32})/", address).group(1)
            check(token not in words and words.startswith("file://"), f"the browser is given {words}")
            page = pathlib.Path(words.removeprefix("file://"))
            modes = [stat.S_IMODE(one.stat().st_mode) for one in (page, page.parent)]
            check(modes == [0o600, 0o700], f"for this user alone: {[oct(mode) for mode in modes]}")
            check(f"url={address}" in page.read_text(), "which leads to the address")
            check(("is being opened" in said) == (code == 0), f"xdg-open ends with {code}: {said.strip()}")
            process.send_signal(signal.SIGINT)
            check(process.wait(20) == 0 and not list(temporary.iterdir()), "nothing is left of it")
