#!/usr/bin/python3
"""The JSON Schemas of `accdec schema` against an independent validator, and against the readers.

schema.py ACCDEC PROBLEMS: every shipped task, study and suite, and results made from tasks, must validate; of each
kind one file is then spoilt key by key (unknown, of another type, out of range, missing), and schema and reader must
both refuse it. Exit code 77 (skipped) without python3-jsonschema.
"""
import copy
import json
import pathlib
import subprocess
import sys
import tempfile
import tomllib

try:
    from jsonschema import Draft202012Validator
except ImportError:
    print("python3-jsonschema is not there; nothing was checked")
    sys.exit(77)

accdec, problems = pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2]).resolve()
folder = pathlib.Path(tempfile.mkdtemp())
failures = []


def run(*arguments):
    return subprocess.run([accdec, *map(str, arguments)], capture_output=True, text=True, cwd=folder, timeout=120)


def validator(kind):
    schema = json.loads(run("schema", kind).stdout)
    Draft202012Validator.check_schema(schema)
    return Draft202012Validator(schema), schema


def toml(value):
    """A value as TOML; tables inline."""
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, dict):
        return "{ " + ", ".join(f"{json.dumps(k)} = {toml(v)}" for k, v in value.items()) + " }"
    if isinstance(value, list):
        return "[" + ", ".join(map(toml, value)) + "]"
    return json.dumps(value)


def variants(schema):
    """The schema itself and the alternatives within it."""
    yield schema
    for alternative in schema.get("anyOf", []):
        yield from variants(alternative)


def wrong_values(schema):
    """Values that a key's schema does not allow: another type, a word that is none, numbers beyond its range."""
    kinds = {v.get("type") for v in variants(schema)}
    yield {"nonsense": 1} if not kinds & {"object"} else 17
    if not kinds & {"boolean"}:
        yield True
    if any("enum" in v for v in variants(schema)):
        yield "nonsense"
    for v in variants(schema):
        item = v.get("items", {}) if v.get("type") == "array" else {}
        if "array" in kinds and v.get("type") == "array" and item.get("type") in ("number", "integer"):
            yield ["nonsense"]
            if "maximum" in item:
                yield [item["maximum"] * 2 + 1]
        if v.get("type") in ("number", "integer"):
            if "maximum" in v:
                yield v["maximum"] * 2 + 1
            if "minimum" in v:
                yield v["minimum"] - abs(v["minimum"]) - 1
            if "exclusiveMinimum" in v:
                yield v["exclusiveMinimum"]
        if v.get("type") == "integer":
            yield 1.5


def tables(schema, value, path=()):
    """Every table of a file that has keys of its own, with its schema and path."""
    for v in variants(schema):
        if v.get("type") == "object" and "properties" in v and isinstance(value, dict):
            yield v, path
            for key, inner in v["properties"].items():
                if key in value:
                    yield from tables(inner, value[key], path + (key,))
        if v.get("type") == "array" and isinstance(value, list) and value:
            yield from tables(v.get("items", {}), value[0], path + (0,))


def at(value, path):
    for step in path:
        value = value[step]
    return value


def spoilt(schema, good):
    """Copies of a file, each with one thing wrong, and what it is."""
    for table, path in tables(schema, good):
        place = "/".join(map(str, path))
        bad = copy.deepcopy(good)
        at(bad, path)["nonsense_key"] = 1
        yield bad, f"{place}/nonsense_key"
        for key in table.get("required", []):
            bad = copy.deepcopy(good)
            del at(bad, path)[key]
            yield bad, f"{place} without {key}"
        for key, of in table["properties"].items():
            for wrong in wrong_values(of):
                bad = copy.deepcopy(good)
                at(bad, path)[key] = wrong
                yield bad, f"{place}/{key} = {wrong}"


def check_files():
    checked = 0
    for path in sorted(problems.rglob("*.toml")):
        content = tomllib.loads(path.read_text())
        kind = ("controller" if path.parent.name == "controllers" else "study" if "compute" in content
                else "suite" if "problem" in content or "hypercube" in content else "task")
        for error in validators[kind][0].iter_errors(content):
            failures.append(f"{path}: {'/'.join(map(str, error.path))}: {error.message}")
        checked += 1
    print(f"{checked} shipped files")
    for name in ["corner/acceleration-jerk.toml", "corner/exact-stop.toml", "corner/vibration-band.toml"]:
        made = run("design", problems / name, "--json", "-", "-q", "--time-limit", "5")
        result = json.loads(made.stdout)
        for error in validators["result"][0].iter_errors(result):
            failures.append(f"result of {name}: {'/'.join(map(str, error.path))}: {error.message}")
    return result


def check_spoilt(kind, good, name, write, command):
    check, schema = validators[kind]
    count = 0
    for error in check.iter_errors(good):
        failures.append(f"the {kind} to be spoilt is no {kind}: {error.message}")
    path = folder / name
    path.write_text(write(good))
    answer = run(*command)
    if answer.returncode == 2:
        failures.append(f"{kind}: the reader refuses the good one: {answer.stderr[:200]}")
    for bad, what in spoilt(schema, good):
        path.write_text(write(bad))
        if check.is_valid(bad):
            failures.append(f"{kind}: the schema accepts {what}")
        answer = run(*command)
        if answer.returncode != 2 or not answer.stderr.startswith(name + ":"):
            failures.append(f"{kind}: the reader accepts {what}: exit {answer.returncode}, {answer.stderr[:200]}")
        count += 1
    print(f"{count} spoilt {kind} files")


def as_toml(tree):
    return "\n".join(f"{key} = {toml(value)}" for key, value in tree.items()) + "\n"


TASK = {
    "title": "t",
    "sample_period_ms": 1,
    "filter": {"kind": "boxcar", "order": 8, "shaper": "zv", "shaper_delay": 3},
    "baseline": {"kind": "hann", "order": 8},
    "design": {"order_max": 100},
    "axis": [{"name": "x", "velocity_max_mm_s": 500, "mass_kg": 2, "force_max_N": 100}, {"name": "y"}],
    "corner": [{"name": "A", "angle_deg": 90, "feed_in_mm_min": 600, "error_max_um": 50, "delay_samples": 9}],
    "mode": [{"frequency_Hz": [30, 40], "residual_max": 0.9}],
    "program": {"error_max_um": 10},
}
STUDY = {
    "title": "s",
    "task": "good.toml",
    "compute": ["delays"],
    "method": "exact",
    "case": [{"name": "a", "set": {"filter.order": 9}}, {"name": "b"}],
    "vary": [
        {"key": "corner.*.error_max_um", "values": [10, 20]},
        {"key": "corner.A.angle_deg", "range": {"from": 80, "to": 90, "count": 2}},
    ],
    "ratio": [{"name": "r", "of": "delays.cycle_time_ms", "to": "delays.corner_time_ms"}],
    "figure": [
        {
            "name": "f",
            "kind": "heat",
            "x": "corner.*.error_max_um",
            "y": ["corner.A.angle_deg"],
            "z": "delays.cycle_time_ms",
            "where": {"case": "a"},
        }
    ],
}
SUITE = {
    "title": "s",
    "solvers": ["ipopt"],
    "starts": 1,
    "repeats": 1,
    "time_limit_s": 1,
    "reference_time_limit_s": 2,
    "reduced": ["nlopt-cobyla"],
    "variant": [{"name": "v", "solver": "ipopt", "form": "reduced"}],
    "problem": [{"name": "p", "task": "good.toml", "formulation": ["margin"], "order": 9, "sizes": [1]}],
    "hypercube": [{"name": "h", "task": "good.toml", "count": 1, "formulation": ["delay"],
                   "ranges": {"sample_period_ms": [1, 2]}}],
}

validators = {kind: validator(kind) for kind in ("task", "study", "suite", "result", "controller")}
result = check_files()
(folder / "good.toml").write_text(as_toml(TASK))
check_spoilt("task", TASK, "task.toml", as_toml, ("evaluate", "task.toml", "--quiet"))
check_spoilt("study", STUDY, "study.toml", as_toml, ("study", "study.toml", "--out", "out", "--quiet"))
check_spoilt("suite", SUITE, "suite.toml", as_toml, ("compare", "suite.toml", "--out", "compared", "--quiet"))
check_spoilt("result", result, "result.json", lambda r: json.dumps(r, indent=1), ("verify", "result.json", "--quiet"))
for failure in failures[:40]:
    print(failure)
print(f"{len(failures)} failures")
sys.exit(1 if failures else 0)
