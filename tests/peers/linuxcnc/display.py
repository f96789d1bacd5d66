#!/usr/bin/python3
"""What LinuxCNC takes for its user interface: switches the machine on, homes it, runs one program, and ends."""
import os
import subprocess
import sys
import time

import linuxcnc

command, status, messages = linuxcnc.command(), linuxcnc.stat(), linuxcnc.error_channel()


def said():
    texts = []
    while True:
        message = messages.poll()
        if not message:
            return texts
        texts.append(message[1].strip())


def fail(why):
    print("PEER-FAIL:", why, *said(), flush=True)
    sys.exit(1)


def wait(condition, seconds, what, lasting=0.0):
    """Until the condition has held for so long: between two blocks the queue may be empty for a moment."""
    begin, held = time.monotonic(), None
    while True:
        status.poll()
        if not condition():
            held = None
        elif time.monotonic() - (held := held or time.monotonic()) >= lasting:
            return
        if time.monotonic() - begin > seconds:
            fail("no " + what + " within " + str(seconds) + " s")
        time.sleep(0.005)


def sampler(on):
    subprocess.check_call(["halcmd", "setp", "sampler.0.enable", "1" if on else "0"])


command.state(linuxcnc.STATE_ESTOP_RESET)
command.wait_complete()
command.state(linuxcnc.STATE_ON)
wait(lambda: status.task_state == linuxcnc.STATE_ON, 20, "machine on")
command.home(-1)
wait(lambda: all(status.homed[:3]), 20, "home")
command.mode(linuxcnc.MODE_AUTO)
command.wait_complete()
command.program_open(os.environ["PEER_PROGRAM"])
command.wait_complete()
sampler(True)
command.auto(linuxcnc.AUTO_RUN, 0)
wait(lambda: status.interp_state != linuxcnc.INTERP_IDLE, 20, "start of the program")
wait(lambda: status.interp_state == linuxcnc.INTERP_IDLE and status.queue == 0 and status.inpos,
     float(os.environ.get("PEER_SECONDS", "600")), "end of the program", lasting=0.5)
time.sleep(0.1)
sampler(False)
overruns = subprocess.check_output(["halcmd", "getp", "sampler.0.overruns"], text=True).strip()
time.sleep(0.5)  # what is still in the sampler's queue gets written
for text in said():
    print("PEER-MESSAGE:", text, flush=True)
print("PEER-DONE overruns", overruns, flush=True)
