"""Results damaged and forged: `verify` may refuse or reject them, or accept what is still true; never a crash, never a
lie."""
import base64
import copy
import gzip
import json
from pathlib import Path

import model
import tasks
from harness import read_json


def _paths(value, here=()):
    """Every place in a JSON value."""
    yield here
    items = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ()
    for key, member in items:
        yield from _paths(member, here + (key,))


def _change(rng, value):
    """Another value in place of one."""
    if isinstance(value, bool):
        return not value
    if isinstance(value, (int, float)) and rng.random() < 0.8:
        return rng.choice(
            [
                value * (1.0 + rng.choice([-1, 1]) * 10.0 ** rng.uniform(-12, 0)),
                -value,
                value + 1,
                value - 1,
                0,
                value * 2,
                1e308,
                5e-324,
            ]
        )
    if isinstance(value, str):
        return rng.choice(["", value + "x", "optimal", "feasible", "infeasible", "blend", "stop"])
    if isinstance(value, list) and value:
        changed = copy.deepcopy(value)
        rng.choice([changed.reverse, changed.pop, lambda: changed.append(changed[0])])()
        return changed
    return rng.choice([None, True, [], {}, "", 0, -1, 1e300])


def _contradict(rng, forged):
    """One claim that the others, the certificate or the motion contradict, unless it happens to be true."""
    kind, limit = rng.randrange(5), rng.choice(forged["limits"] or [None])
    if kind == 0:
        forged["status"] = rng.choice(["optimal", "feasible", "infeasible", "failed"])
    elif kind == 1:
        forged["stop"] = rng.choice(["finished", "gap reached", "time limit", "interrupted"])
    elif kind == 2:
        forged["verification"]["certificate_checked"] = not forged["verification"]["certificate_checked"]
    elif limit is not None and kind == 3:
        limit["sample"] += rng.choice([-1000, -10, -2, -1, 1, 2, 10, 1000])
    elif limit is not None:
        limit["event"] = rng.choice(["start", "blend", "stop", "none"])
    return forged


def mutate(rng, result):
    """A result with one to three changes in random places; forged bounds and statuses are tried most."""
    forged = copy.deepcopy(result)
    if rng.random() < 0.3:
        steps = rng.choice([1, 2, 5])
        period = result["sample_period_s"]
        for key in ("lower_bound_s", "cycle_time_s"):
            if forged.get(key) is not None and rng.random() < 0.7:
                forged[key] += rng.choice([-1, 1]) * steps * period
        forged["status"] = rng.choice(["optimal", "feasible", "infeasible"])
        if forged.get("lower_bound_s") and forged.get("cycle_time_s"):
            forged["gap"] = (forged["cycle_time_s"] - forged["lower_bound_s"]) / forged["cycle_time_s"]
        if forged["corners"] and rng.random() < 0.5:
            forged["corners"][0]["delay_samples"] = max(0, forged["corners"][0]["delay_samples"] + rng.choice([-1, 1]))
        return forged
    if rng.random() < 0.2:
        return _contradict(rng, forged)
    return change_places(rng, forged)


def change_places(rng, forged):
    """One to three places of a result changed or taken away."""
    places = [p for p in _paths(forged) if p and p[0] != "task"]
    # Certificates have most of the places; the rest is to have its share.
    outside = [p for p in places if p[0] != "certificate"]
    for _ in range(rng.randrange(1, 4)):
        place = rng.choice(places if rng.random() < 0.5 else outside)
        parent = forged
        try:
            for key in place[:-1]:
                parent = parent[key]
            if rng.random() < 0.1:
                del parent[place[-1]]
            else:
                parent[place[-1]] = _change(rng, parent[place[-1]])
        except (KeyError, IndexError, TypeError):
            pass  # an earlier change took the place away
    return forged


def pack(rng, forged):
    """Its certificate as long ones are stored, often damaged after that; as it is where there is none."""
    if not isinstance(forged.get("certificate"), dict):
        return forged
    packed = bytearray(gzip.compress(json.dumps(forged["certificate"]).encode(), 6))
    kind = rng.randrange(6)
    if kind == 0:
        packed[rng.randrange(len(packed))] = rng.randrange(256)
    elif kind == 1:
        del packed[rng.randrange(len(packed)) :]
    elif kind == 2:
        packed = packed * 2
    elif kind == 3:
        packed = bytearray(gzip.compress(b"[" * rng.choice([1, 1000, 20_000_000]), 1))
    return forged | {
        "certificate": {"gzip": base64.b64encode(packed).decode(), "kind": "packed", "schema": "accdec.certificate/1"}
    }


def mutate_text(rng, text):
    """Bytes changed, cut out, doubled or cut off."""
    data = bytearray(text.encode())
    for _ in range(rng.randrange(1, 4)):
        at, length = rng.randrange(len(data)), rng.randrange(1, 40)
        kind = rng.randrange(4)
        if kind == 0:
            data[at] = rng.randrange(256)
        elif kind == 1:
            del data[at : at + length]
        elif kind == 2:
            data[at:at] = data[at : at + length]
        elif len(data) > 2 and rng.random() < 0.3:
            del data[at:]
        data = data or bytearray(b" ")
    return bytes(data)


# Members that a recheck computes itself. The place of a limit's largest use may differ if its use is equal there
# (`_misplaced`).
CHECKED = ("sample_period_s", "cycle_time_s", "corner_time_s", "corners", "limits", "verification", "filter")
FREE = ("sample", "event", "worst", "frequency_Hz", "name")


def _changed_number(original, forged, where=""):
    """The first checked number that is another one by more than what verify grants rounding; None without."""
    if isinstance(original, dict) and isinstance(forged, dict):
        pairs = [(key, original[key], forged.get(key)) for key in original if key not in FREE]
    elif isinstance(original, list) and isinstance(forged, list):
        if len(original) != len(forged):
            return where
        pairs = [(i, a, b) for i, (a, b) in enumerate(zip(original, forged))]
    else:
        numbers = all(isinstance(v, (int, float)) and not isinstance(v, bool) for v in (original, forged))
        same = abs(original - forged) <= 1e-8 * abs(original) + 1e-8 if numbers else original == forged
        return None if same else where
    found = (_changed_number(a, b, f"{where}.{key}") for key, a, b in pairs)
    return next((f for f in found if f), None)


def _misplaced(task, result, original):
    """The first limit of an axis that is said to be used most at a sample where it is not; None without."""
    delays = [c["delay_samples"] for c in result["corners"]]
    for recorded, true in zip(result["limits"], original["limits"]):
        if recorded == true or not recorded["axis"]:
            continue
        value = model.value_at(task, result["filter"]["taps"], delays, recorded)
        if value is None or abs(value - true["value"]) > 1e-8 * abs(true["value"]) + 1e-10:
            return f"{recorded['kind']} {recorded['axis']} at {recorded['sample']} of the {recorded['event']}"
    return None


def _contradiction(result):
    """What of status, stop, bound, gap and certificate does not go together; None without."""
    if result["status"] == "infeasible":
        return None
    optimal, gap, bound = result["status"] == "optimal", result.get("gap"), result.get("lower_bound_s")
    if (gap is None) != (bound is None) or (bound is None) != (result.get("certificate") is None):
        return "a bound, its gap and its proof do not stand together"
    family = result.get("family_bound_s")
    if family is not None:  # a design of settings is optimal within its families
        gap = (result["cycle_time_s"] - family) / result["cycle_time_s"]
    if optimal and (gap is None or gap > 1e-8 or result.get("stop") not in (None, "finished")):
        return "optimal with a gap or a search that was stopped"
    if not optimal and gap is not None and gap < 1e-10:
        return "feasible without a gap"
    return None


def _broken(task, result):
    use, name = model.worst_use(task, result["filter"]["taps"], [c["delay_samples"] for c in result["corners"]])
    return f"breaks {name}: {use:.9f}" if use > 1.0 + 1e-7 else None


def lie(task, original, path, wrong=None):
    """What is false in an accepted result; None if all of it is true. The task is part of the file and was not changed
    on purpose. `wrong` says what a simulation of a task and result finds, instead of the model here."""
    try:
        result = read_json(path)
    except ValueError:
        return "accepted what is no JSON"
    if result["task"] != original["task"]:
        return None  # another task: its truth is not known here
    if result["status"] == "infeasible":
        if original["status"] != "infeasible":
            return "an infeasibility that is none"
    if [c["delay_samples"] for c in result["corners"]] == [c["delay_samples"] for c in original["corners"]]:
        other = next((w for w in (_changed_number(original[k], result.get(k), k) for k in CHECKED) if w), None)
        if other:
            return f"{other} is not what it was"
        place = None if wrong else _misplaced(task, result, original)
        if place:
            return f"a limit is not used most where it says: {place}"
    if _contradiction(result):
        return _contradiction(result)
    if result["status"] == "infeasible":
        return None
    broken = wrong(task, result) if wrong else _broken(task, result)
    if broken:
        return broken
    time = "corner_time_s" if original["task"]["design"]["objective"] == "corner" else "cycle_time_s"
    optimum = original[time] if original["status"] == "optimal" else None
    if optimum is not None:
        near = 1e-6 * optimum
        if result["status"] == "optimal" and abs(result[time] - optimum) > near:
            return f"optimal at {result[time]} s, the optimum is {optimum} s"
        if (result.get("lower_bound_s") or 0.0) > optimum + near:
            return f"a bound of {result['lower_bound_s']} s above the optimum of {optimum} s"
    return None


def run(attack):
    task_path, result_path, forged_path = (
        attack.path("task.toml"),
        attack.path("result.json"),
        attack.path("forged.json"),
    )
    task = original = None
    while attack.more():
        rng = attack.rng()
        if original is None or attack.case % 50 == 0:
            task = attack.task_file(rng.choice([k for k in tasks.KINDS if k != "speed"]), longest=8)
            code, _, _ = attack.run("design", task_path, "--json", result_path, "-q", "--time-limit", 3)
            original = read_json(result_path) if code == 0 else None
        if original is None:
            continue
        if rng.random() < 0.3:
            Path(forged_path).write_bytes(mutate_text(rng, Path(result_path).read_text()))
        else:
            forged = mutate(rng, original)
            if rng.random() < 0.3:
                forged = pack(rng, forged)
                attack.count("certificates packed")
            Path(forged_path).write_text(json.dumps(forged, indent=2))
        code, out, err = attack.run("verify", forged_path)
        attack.count("results mutated")
        if code == 0:
            attack.count("accepted, still true")
            why = lie(task, original, forged_path)
            if why:
                attack.fail(f"accepted: {why}", task_path, result_path, forged_path)
        elif code is None:
            attack.fail("verify did not end", forged_path)
