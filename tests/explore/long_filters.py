"""Answers about filters of many taps: short, with every peak; the program holds what the page would send back."""
import json
import time

FEED, PERIOD = 6000, 1e-3  # mm/min, s


def boxcar(taps):
    """An axis at a constant feed: its acceleration is a rectangle, its jerk single samples."""
    return {"sample_period_ms": 1e3 * PERIOD, "filter": {"kind": "boxcar", "order": taps - 1},
            "axis": [{"name": "x", "acceleration_max_mm_s2": 1e5, "jerk_max_mm_s3": 1e7}, {"name": "y"}],
            "corner": [{"name": "A", "angle_deg": 90, "feed_in_mm_min": FEED, "delay_samples": taps // 2}]}


def peaks(check, answer, taps):
    view, speed = answer["views"][0], FEED / 60
    drawn = {q["kind"]: next(a for a in q["axes"] if a["name"] == "x")["values"] for q in view["quantities"]}
    wanted = {"velocity": speed, "acceleration": speed / taps / PERIOD, "jerk": speed / taps / PERIOD**2}
    for kind, most in wanted.items():
        found = max(map(abs, drawn[kind]))
        check(abs(found / most - 1) < 1e-6, f"{kind} of {taps} taps: at most {found:.6g} is drawn, {most:.6g} in closed form")
    counts = {len(v) for v in (view["time_ms"], view["speed_mm_s"], view["path"]["x_um"], view["path"]["off_um"], *drawn.values())}
    check(len(counts) == 1 and max(counts) <= 4000, f"of {counts} points")
    check(view["time_ms"] == sorted(view["time_ms"]), "in the order of time")
    blend, stop = view["events"]["blend"], view["events"]["stop"]
    step = view["time_ms"][2] - view["time_ms"][0]  # of a group
    check(abs(view["time_ms"][blend]) <= step and abs(view["time_ms"][stop] - 1e3 * PERIOD * (taps + taps // 2)) <= 2 * step + 3,
          f"the events are where they were: {view['time_ms'][blend]}, {view['time_ms'][stop]} ms")
    error = min((x * x + y * y) ** 0.5 for x, y in zip(view["path"]["x_um"], view["path"]["y_um"]))
    check(abs(error / (1e6 * answer["result"]["corners"][0]["corner_error_m"]) - 1) < 1e-4, f"{error} um from the corner")


def long_filters(check, p):
    began = time.monotonic()
    _, text = p.post("design", boxcar(19999), seconds=20)
    answer = json.loads(text)
    check(len(text) < 1.5e6, f"19999 taps: {len(text) / 1e6:.2f} MB in {time.monotonic() - began:.1f} s")
    peaks(check, answer, 19999)
    most = json.loads(p.post("design", boxcar(99999), seconds=20)[1])
    status, text = p.post("view", b"", held=most["held"], seconds=20)
    check(status == 200 and len(text) < 1e6, f"99999 taps are drawn, too: {len(text) / 1e6:.2f} MB")
    peaks(check, {"result": most["result"], "views": [json.loads(text)]}, 99999)
    status, text = p.post("export", b"", held=most["held"], format="csv", seconds=20)
    rows = [line for line in text.decode().splitlines() if line[:1].isdigit()]
    check(status == 200 and len(rows) == 99999, f"{len(rows)} taps are exported of the result that is held")


def held(check, p, task):
    """A question about a result that is held is answered as that with the result itself; its proof is kept, too."""
    answer = json.loads(p.post("design", task, client="held")[1])
    for name, more in (("export", {"format": "csv"}), ("export", {"format": "json"}), ("view", {"corner": 0})):
        sent, kept = p.post(name, answer["result"], **more), p.post(name, b"", held=answer["held"], **more)
        check(sent == kept and kept[0] == 200, f"{name} {more}: the same of the result that is held, {len(kept[1])} bytes")
    result = json.loads(p.post("export", b"", held=answer["held"], format="result")[1])
    check("certificate" in result and result["filter"] == answer["result"]["filter"], "the result has its proof")
    for _ in range(2):
        p.post("design", task, client="held")
    for number in (answer["held"], 10**9):
        status, text = p.post("view", b"", held=number)
        check(status == 400 and "no longer" in json.loads(text)["error"], f"held={number}: {json.loads(text)['error']}")
    for number in ("x", "-1", "1.5", ""):
        check(p.post("view", b"", held=number)[0] == 400, f"held={number!r} is refused")
