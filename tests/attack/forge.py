"""Certificates forged: one node, row, lemma or claim of every kind that there is, so that `verify` meets each of them
in a wrong place. The kinds are those of the checker's own header: a new one fails here until it is forged, too."""
import copy
import json
import re
from pathlib import Path

import mutate
import tasks
from harness import read_json

HEADER = Path(__file__).resolve().parents[2] / "lib/include/accdec/certificate.hpp"


def _tag(*tags):
    return lambda entry: isinstance(entry, list) and bool(entry) and entry[0] in tags


def _second(*tags):
    return lambda entry: isinstance(entry, list) and len(entry) == 3 and entry[1] in tags


# How the kinds of the header look in a file.
PROOFS = {
    "ConstantFeed": lambda c: c["kind"] == "constant feed",
    "CornerSpeed": lambda c: c["kind"] == "corner speed",
    "Enumeration": lambda c: c["kind"] == "enumeration",
    "BranchAndBound": lambda c: c["kind"] == "branch and bound",
    "FamilyEnumeration": lambda c: c["kind"] == "families",
    "CornerFeeds": lambda c: c["kind"] == "corner feeds",
}
NODES = {
    "TooLong": lambda n: n is None,
    "Unreachable": lambda n: n == "unreachable",
    "Refuted": lambda n: isinstance(n, int),
    "RefutedSymmetric": lambda n: isinstance(n, list) and len(n) == 2 and all(isinstance(i, int) for i in n),
    "SymmetricOrders": _tag("symmetric"),
    "Split": _second("d", "k"),
    "OrderSplit": _tag("N"),
    "ResponseSplit": _second("B"),
    "ByLemma": _tag("lemma"),
    "ContourSplit": _second("c"),
    "ReversalSplit": lambda n: isinstance(n, list) and len(n) == 4 and n[1] == "r",
}
ROWS = {
    "TapDifference": _tag("jerk"),
    "EventForce": _tag("force start", "force stop"),
    "Blend": _tag("blend acceleration", "blend jerk", "blend force"),
    "Error": _tag("error"),
    "RangeError": _tag("range error"),
    "Budget": _tag("budget"),
    "Vibration": _tag("vibration"),
    "EventPower": _tag("power start", "regeneration stop"),
    "BlendPower": _tag("blend power", "blend regeneration"),
    "Speed": _tag("speed"),
    "Response": _tag("response"),
    "Contour": _tag("contour"),
    "Reversal": _tag("reversal"),
    "Width": _tag("width"),
}


def kinds_of_header():
    """Names in the header's three variants: proofs, nodes, rows."""
    text = HEADER.read_text(encoding="utf-8")
    lists = [
        re.search(pattern + r"\s*std::variant<([^>]*)>", text)[1]
        for pattern in (r"struct Certificate \{", r"using Node =", r"using Row =")
    ]
    return [{name.strip().removeprefix("proof::") for name in names.split(",")} for names in lists]


def _trees(certificate):
    """The tree and those of the lemmas."""
    return [certificate["tree"], *(lemma["tree"] for lemma in certificate.get("lemmas", []))]


def places(certificate):
    """By kind: the lists and indices at which it stands. Of proofs: the certificate itself."""
    found = {name: [(None, None)] for name, is_it in PROOFS.items() if is_it(certificate)}
    if certificate["kind"] != "branch and bound":
        return found
    for known, lists in ((NODES, _trees(certificate)), (ROWS, certificate["multipliers"])):
        for entries in lists:
            for i, entry in enumerate(entries):
                for name in (n for n, is_it in known.items() if is_it(entry)):
                    found.setdefault(name, []).append((entries, i))
    for member in ("conflict", "corner_of", "in_position"):
        if member in certificate:
            found[member] = [(certificate, member)]
    for lemma in certificate.get("lemmas", []):
        found.setdefault("window" if "window" in lemma else "order", []).append(
            (lemma, "window" if "window" in lemma else "order")
        )
        found.setdefault("delays", []).append((lemma, "delays"))
        if "from" in lemma:
            found.setdefault("from", []).append((lemma, "from"))
    return found


def _moved(rng, entry):
    """Another entry of the same form: one of its numbers is another."""
    if isinstance(entry, bool) or not isinstance(entry, (int, float, list)):
        return entry
    if isinstance(entry, int):
        return entry + rng.choice([-1000, -2, -1, 1, 2, 1000])
    if isinstance(entry, float):
        return rng.choice([0.0, -entry, 2.0 * entry, 0.5 * entry, entry + 0.01, 1e300])
    numbers = [i for i, e in enumerate(entry) if isinstance(e, (int, float, list)) and not isinstance(e, bool)]
    changed = copy.deepcopy(entry)
    if numbers:
        i = rng.choice(numbers)
        changed[i] = _moved(rng, entry[i])
    return changed


def forge(rng, certificate, kind):
    """Damages one entry of a kind: moved, taken away, doubled, or another entry of the proof in its place."""
    holder, at = rng.choice(places(certificate)[kind])
    if kind == "FamilyEnumeration":
        member = rng.choice(["refuted", "bound_samples"])
        certificate[member] = _moved(rng, certificate[member])
        return
    if holder is None:
        others = ["constant feed", "corner speed", "enumeration", "branch and bound", "packed", ""]
        certificate["kind"] = rng.choice([k for k in others if k != certificate["kind"]])
        if certificate["kind"] in others[:3] and rng.random() < 0.8:  # in its whole form
            for member in [m for m in certificate if m not in ("kind", "schema")]:
                del certificate[member]
            certificate["schema"] = "accdec.certificate/1"
        return
    how = rng.randrange(4)
    if how == 0 or isinstance(holder, dict):
        if isinstance(holder, dict) and how == 1:
            del holder[at]
        else:
            holder[at] = _moved(rng, holder[at])
    elif how == 1:
        del holder[at]
    elif how == 2:
        holder.insert(at, copy.deepcopy(holder[at]))
    else:
        holder[at] = copy.deepcopy(rng.choice(holder))
        if rng.random() < 0.5:
            holder[at] = rng.choice([None, "unreachable", 0, ["lemma", 0], [0, 0], ["symmetric"], ["N", 3]])


def _task(period, limits, corner, speed=None):
    """One corner of equal legs and axes. `corner`: angle, heading, feed in mm/min, error in um."""
    angle, heading, feed, error = corner
    corner = {"name": "A", "angle_deg": angle, "heading_deg": heading, "error_max_um": error}
    corner |= {"feed_in_mm_min": feed, "feed_out_mm_min": feed} | ({"speed_min_mm_s": speed} if speed else {})
    axes = [limits | {"name": name} for name in ("x", "y")]
    return {"sample_period_ms": period, "axis": axes, "corner": [corner], "design": {"order_max": 60}}


# Settings of a control: the proof counts the members of a family.
SETTINGS = _task(1.0, {"acceleration_max_mm_s2": 6e3, "jerk_max_mm_s3": 500e3}, (95.0, 0.0, 6000.0, 50.0))
SETTINGS["design"] = {"family": "averages", "stages": 2, "length_max_ms": 32}

# Limits outside the convex class, so tight that proofs need chords of the speed and splits of responses. They also need
# splits of the time at which a path changes from one leg's strip to the other's. Others are of the sample at which an
# axis with dry friction reverses.
TIGHT = {
    "slow": _task(
        1.0, {"acceleration_max_mm_s2": 10e3, "jerk_max_mm_s3": 1500e3}, (90.0, 0.0, 6000.0, 60.0), speed=33.0
    ),
    "weak": _task(
        3.0,
        {"mass_kg": 34.0, "damping_N_s_m": 50.0, "force_max_N": 465.0, "power_max_W": 110.0,
         "regeneration_max_W": 60.0},
        (100.0, 20.0, 24000.0, 200.0),
    ),
    "contour": _task(1.0, {"acceleration_max_mm_s2": 6e3, "jerk_max_mm_s3": 500e3}, (70.0, 0.0, 6000.0, 120.0)),
}
TIGHT["turning"] = _task(
    1.0, {"mass_kg": 34.0, "coulomb_N": 60.0, "force_max_N": 300.0}, (40.0, 50.0, 9000.0, 150.0)
)
# Delays of two corners by one in-position width.
TIGHT["width"] = _task(1.0, {"acceleration_max_mm_s2": 6e3}, (95.0, 0.0, 6000.0, 40.0))
TIGHT["width"]["corner"].append(
    {"name": "B", "angle_deg": 60.0, "feed_in_mm_min": 4000.0, "error_max_um": 25.0, "weight": 2.0}
)
TIGHT["width"]["controller"] = {"delays": ["in-position"]}
TIGHT["contour"]["corner"][0] |= {"feed_out_mm_min": 4000.0, "contour_max_um": 60.0}


def draw(rng, case):
    """Tasks whose proofs have, together, every kind."""
    kinds = ("several", "symmetric", "power", "vibration", "several symmetric", "corner speed", "force", "given")
    kinds += ("slow", "constant feed", "power symmetric", "several twice", "regeneration", "infeasible", "weak")
    kind = kinds[case % 48 % len(kinds)]
    if case % 48 >= 45:
        return copy.deepcopy(SETTINGS)
    if case % 48 in (42, 43, 44):
        kind = ("width", "turning", "contour")[case % 48 - 42]
    if kind in TIGHT:
        return copy.deepcopy(TIGHT[kind])
    base, *more = kind.split()
    base = {"corner": "speed", "constant": "force", "infeasible": "vibration"}.get(base, base)
    task = tasks.draw(rng, base, 8)
    corner = task["corner"][0]
    if more == ["symmetric"]:
        task["design"] = {"symmetric": True}
    if more == ["twice"]:
        task["corner"].append(corner | {"name": "Z"})
    if kind == "corner speed":
        corner["angle_deg"] = 60.0
        corner["speed_min_mm_s"] = 0.8 * min(corner["feed_in_mm_min"], corner["feed_out_mm_min"]) / 60.0
        corner["error_max_um"] *= 0.02
    if kind == "constant feed":
        for axis in task["axis"]:
            axis.setdefault("mass_kg", 10.0)
            axis["damping_N_s_m"], axis["force_max_N"] = 100.0, 1e-3
    if kind == "infeasible":
        task["design"] = {"order_max": 3}
    return task


def _worse(attack, task_path, original):
    """A longer design of the task, for a proof that is to claim too much; None if there is none."""
    path = attack.path("worse.json")
    code, _, _ = attack.run("design", task_path, "--method", "nlp", "--json", path, "-q", "--time-limit", 3)
    worse = read_json(path) if code == 0 else None
    longer = worse and worse["cycle_time_s"] > original["cycle_time_s"] * (1.0 + 1e-6)
    return worse if longer else None


def _claimed(worse, certificate):
    """The longer design as if the proof were about it."""
    result = copy.deepcopy(worse) | {"status": "optimal", "gap": 0.0, "lower_bound_s": worse["cycle_time_s"]}
    result["certificate"] = certificate
    result["verification"]["certificate_checked"] = True
    if certificate.get("bound_samples") is not None:
        certificate["bound_samples"] = worse["cycle_time_s"] / worse["sample_period_s"]
    return result


def run(attack):
    known = [set(PROOFS), set(NODES), set(ROWS)]
    for ours, theirs in zip(known, kinds_of_header()):
        if ours != theirs:
            attack.fail(f"kinds that are not forged, or there no more: {sorted(ours ^ theirs)}")
    task_path, result_path, forged_path = (attack.path(f) for f in ("task.toml", "result.json", "forged.json"))
    never = set().union(*known) | {"window", "order", "delays", "from", "conflict", "corner_of", "in_position"}
    while attack.more():
        rng = attack.rng()
        task = draw(rng, attack.case)
        Path(task_path).write_text(tasks.to_toml(task))
        attack.run("design", task_path, "--json", result_path, "-q", "--time-limit", 3)
        original = read_json(result_path) if Path(result_path).exists() else None
        if not original or not original.get("certificate") or original["certificate"]["kind"] == "packed":
            continue
        worse = _worse(attack, task_path, original) if original["status"] == "optimal" else None
        for kind in places(original["certificate"]):
            never.discard(kind)
            forged = copy.deepcopy(original)
            for _ in range(rng.choice([1, 1, 2])):
                if kind in places(forged["certificate"]):
                    forge(rng, forged["certificate"], kind)
            if worse and rng.random() < 0.5:
                forged = _claimed(worse, forged["certificate"])
            elif rng.random() < 0.1:
                forged["status"] = "infeasible"
            Path(forged_path).write_text(json.dumps(forged))
            code, _, _ = attack.run("verify", forged_path)
            attack.count(f"{kind} forged")
            if code == 0:
                attack.count("accepted, still true")
                lie = mutate.lie(task, original, forged_path)
                if lie:
                    attack.fail(f"accepted with a forged {kind}: {lie}", task_path, result_path, forged_path)
            elif code is None:
                attack.fail("verify did not end", forged_path)
    if attack.case >= 48 and never:
        attack.fail(f"no proof had {sorted(never)}: other tasks are to be drawn")
