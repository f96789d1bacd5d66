"""What all parts share: running the program, counting what was checked, keeping the files of what went wrong."""
import json
import os
import random
import shutil
import signal
import subprocess
import tempfile
import time
from collections import Counter
from pathlib import Path

import tasks


class Attack:
    """One part's run. A part calls `more()` before each case; cases repeat by seed, part name and number."""

    def __init__(self, part, binary, seed, folder, seconds=None, cases=None):
        self.part, self.binary, self.seed = part, str(Path(binary).resolve()), seed
        self.keep = Path(folder).resolve() / part
        self.work = Path(tempfile.mkdtemp(prefix=f"accdec-attack-{part}-"))
        self.deadline = time.monotonic() + seconds if seconds else None
        self.cases, self.case, self.counts, self.wrong = cases, -1, Counter(), []

    def more(self):
        self.case += 1
        late = self.deadline is not None and time.monotonic() > self.deadline
        return not late and (self.cases is None or self.case < self.cases)

    def rng(self):
        return random.Random(f"{self.seed}/{self.part}/{self.case}")

    def path(self, name):
        return str(self.work / name)

    def run(self, *arguments, timeout=120, **options):
        """Exit code (negative: signal, None: did not end in time), standard output, standard error."""
        try:
            done = subprocess.run(
                [self.binary, *map(str, arguments)],
                capture_output=True,
                timeout=timeout,
                stdin=subprocess.DEVNULL,
                **options,
            )
        except subprocess.TimeoutExpired:
            return None, "", "did not end"
        code = done.returncode
        if code is not None and (code < 0 or code > 2):
            files = [a for a in map(str, arguments) if os.path.isfile(a)]
            self.fail(f"crashed with {code}: {' '.join(map(str, arguments))}", *files)
        return code, done.stdout.decode(errors="replace"), done.stderr.decode(errors="replace")

    def start(self, *arguments):
        """A process of its own group, so that its children can be killed with it."""
        return subprocess.Popen(
            [self.binary, *map(str, arguments)],
            stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
            start_new_session=True,
        )

    def kill(self, process):
        try:
            os.killpg(process.pid, signal.SIGKILL)
        except ProcessLookupError:
            pass
        process.wait()

    def task_file(self, kind, name="task.toml", longest=16):
        task = tasks.draw(self.rng(), kind, longest)
        Path(self.path(name)).write_text(tasks.to_toml(task))
        return task

    def count(self, what, number=1):
        self.counts[what] += number

    def fail(self, reason, *files):
        """Something is wrong: says what, and keeps the files that show it."""
        self.wrong.append(f"case {self.case}: {reason}")
        self.keep.mkdir(parents=True, exist_ok=True)
        for file in files:
            if os.path.exists(file):
                shutil.copy(file, self.keep / f"{self.seed}-{self.case}-{os.path.basename(file)}")

    def finish(self):
        shutil.rmtree(self.work, ignore_errors=True)


def read_json(path):
    with open(path, encoding="utf-8") as file:
        return json.load(file)


def leftovers(folder, expected):
    """Names in a folder that should not be there."""
    return sorted(set(os.listdir(folder)) - set(expected))
