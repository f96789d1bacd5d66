"""One page under results/: its text and tables, and what the program says today."""
import csv
import json
import re
import subprocess


class Page:
    def __init__(self, name, program, source, folder):
        self.program, self.source, self.folder = program, source, folder
        self.path = source / "results" / name
        self.text = self.path.read_text()
        self.flat = " ".join(self.text.split())
        self.compared, self.wrong = 0, []

    def same(self, what, printed, fresh, within=0.0):
        """Printed and fresh are equal: as text, or as numbers within so much."""
        self.compared += 1
        if within == 0.0:
            equal = printed == fresh
        else:
            equal = abs(float(printed) - float(fresh)) <= within * (1 + 1e-9)
        if not equal:
            self.wrong.append(f"{what}: printed {printed}, computed {fresh}")

    def find(self, pattern):
        """The groups of a regular expression in the page, line ends read as blanks."""
        found = re.search(pattern, self.flat)
        if not found:
            raise LookupError(f"the page has no text like `{pattern}`")
        return found.groups()

    def rows(self, *head):
        """The rows of the table whose head begins with these cells, each as a dictionary by its head."""
        lines = self.text.splitlines()
        for i, line in enumerate(lines):
            names = cells(line)
            if names[: len(head)] != list(head):
                continue
            rows = []
            for row in lines[i + 2 :]:
                if not row.startswith("|"):
                    break
                # The first of two columns with the same head counts.
                rows.append(dict(reversed(list(zip(names, cells(row))))))
            return rows
        raise LookupError(f"the page has no table that begins with {head}")

    def row(self, rows, column, value):
        for row in rows:
            if row[column] == value:
                return row
        raise LookupError(f"no row where {column} is {value}")

    def csv(self, name):
        with open(self.path.parent / name, newline="") as file:
            return list(csv.DictReader(file))

    def run(self, *arguments, exits=(0,)):
        done = subprocess.run([self.program, *map(str, arguments)], cwd=self.folder, capture_output=True, text=True,
                              timeout=300)
        if done.returncode not in exits:
            raise ValueError(f"accdec {' '.join(map(str, arguments))} ended with {done.returncode}: {done.stderr}")
        return done.stdout

    def result(self, *arguments):
        """What a command writes with --json."""
        out = self.folder / "result.json"
        out.unlink(missing_ok=True)
        self.run(*arguments, "--quiet", "--json", out)
        return json.loads(out.read_text())

    def design(self, task, *options):
        """The proved optimum of a task: a file under problems/ or the text of a task."""
        result = self.result("design", self.task(task), "--no-baselines", *options)
        if result["status"] != "optimal":
            raise ValueError(f"{task}: {result['status']}, expected optimal")
        return result

    def task(self, task):
        if "\n" not in str(task):
            return self.source / "problems" / task
        path = self.folder / "task.toml"
        path.write_text(task)
        return path

    def study(self, text):
        """The rows of a study, whose tasks are named from the folder of shipped studies."""
        path = self.folder / "study.toml"
        path.write_text(text.replace('task = "', f'task = "{self.source}/problems/study/'))
        self.run("study", path, "--out", self.folder / "study", "--fresh", "--quiet")
        with open(self.folder / "study/rows.csv", newline="") as file:
            return list(csv.DictReader(file))


def cells(line):
    return [cell.strip() for cell in line.strip().strip("|").split("|")] if line.startswith("|") else []


def ms(seconds):
    return f"{1e3 * seconds:g}" if seconds is not None else ""
