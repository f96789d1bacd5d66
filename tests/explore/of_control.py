"""Today's filter has the delays that the control has, on the page as on the command line."""
import json
import subprocess


def today_at_control(check, p, accdec, home):
    """Averages of 40 and 30 samples have the order 68: a control that stops exactly waits so long at each corner."""
    order, weights, period = 40 + 30 - 2, (1, 2), 1e-3
    task = {"sample_period_ms": 1, "filter": {"kind": "averages", "lengths": [40, 30]},
            "design": {"family": ["averages"], "stages": 2}, "controller": {"delays": ["exact-stop"]},
            "axis": [{"acceleration_max_mm_s2": 6000, "jerk_max_mm_s3": 500000}],
            "corner": [{"name": f"c{w}", "angle_deg": 60 + 35 * (w == 1), "feed_in_mm_min": 4000, "error_max_um": 40,
                        "weight": w} for w in weights]}
    today = json.loads(p.post("design", task, format="given")[1])["result"]
    delays = [corner["delay_samples"] for corner in today["corners"]]
    check(delays == [order, order], f"today's filter stops exactly: delays {delays}")
    took = period * (order + 1 + order * sum(weights))
    check(abs(today["cycle_time_s"] - took) < 1e-12, f"which takes {today['cycle_time_s']} s, by its formula {took} s")
    result = json.loads(p.post("design", task, whole="", seconds=20)[1])["result"]
    file = home / "control.toml"
    file.write_bytes(p.post("file", task)[1])
    printed = subprocess.run([accdec, "design", file, "--json", "-"], capture_output=True, text=True)
    file.unlink()
    saved = json.loads(printed.stdout)["savings"]
    check(result["savings"] == saved and saved["today_s"] == today["cycle_time_s"],
          f"page and command line save the same: {saved['total_s']} s")
    check(json.loads(p.post("families", task)[1]) == {"families": [], "complete": True},
          "filters that this control cannot have are no comparison")
