"""What the tests of a program's page share."""
import sys
import time


def check(holds, what):
    if not holds:
        sys.exit(f"explore path test: {what}")
    print(f"ok: {what}", flush=True)


def wait(browser, condition, what, seconds=20):
    until = time.monotonic() + seconds
    while not browser.value(f"!!({condition})"):
        if time.monotonic() > until:
            check(False, f"within {seconds} s: {what}")
        time.sleep(0.05)
