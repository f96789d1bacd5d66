"""A program on a machine with a servo, dry friction or a supply is planned with one filter, and its loads are drawn."""
import json
import re
import subprocess

from looking import check, wait
from program import Program

MASS, DAMPING, FRICTION = 20.0, 30.0, 40.0  # kg, N s/m, N
AXIS = f"mass_kg = {MASS}\nforce_max_N = 2000\npower_max_W = 900\ndamping_N_s_m = {DAMPING}\n"
LOADS = {"a servo": AXIS + "servo_gain_1_s = 200\nvelocity_feedforward = 0.9\n",
         "dry friction": AXIS + f"coulomb_N = {FRICTION}\n",
         "a supply": AXIS + "[machine]\npower_total_max_W = 500\n",
         "a distance from the path": AXIS + "[program]\ncontour_max_um = 5000\n"}


def planned(accdec, home, code, file, plan):
    """(what the command line says on errors, its result or None)"""
    out = home / "loads.json"
    out.unlink(missing_ok=True)
    ran = subprocess.run([accdec, "--quiet", "program", code, "--task", file, "--plan", plan, "--json", out],
                         capture_output=True, text=True)
    return ran.stderr.strip(), json.loads(out.read_text()) if out.exists() else None


def forces(plan, axis, period, friction):
    """Of every two points that are samples in a row: force, N, and power, W, from the velocities."""
    times, speeds = plan["t_s"], [v / 1e3 for v in plan["velocities_mm_s"][axis]]
    for n in range(1, len(times)):
        if times[n] - times[n - 1] > 1.5 * period or (friction and abs(speeds[n]) < 1e-6):
            continue
        force = MASS * (speeds[n] - speeds[n - 1]) / period + DAMPING * speeds[n]
        if friction:
            force += FRICTION if speeds[n] > 0 else -FRICTION
        yield n, force, force * speeds[n]


def loads_of_motion(name, plan, result, period):
    """Force and power are those of the motion at its samples; the largest is that of the command line."""
    curves = {(load["kind"], load["axis"]): load for load in plan["loads"]}
    axes = [load["axis"] for load in result["axis_loads"]]
    for a, axis in enumerate(axes):
        force, power = curves["force", axis], curves["power", axis]
        check(force["bounds"] == [2000, -2000] and power["bounds"] == [900, None], f"{name}: limits of {axis}")
        peak = next(load["force_peak_N"] for load in result["axis_loads"] if load["axis"] == axis)
        most = max(map(abs, force["values"]))
        check(abs(most - peak) <= 5.1e-4, f"{name}: {most} N of {axis} at most, accdec program says {peak} N")
        rms = next(load["force_rms_N"] for load in result["axis_loads"] if load["axis"] == axis)
        same = abs(force["peak"] - peak) <= 5.1e-5 and abs(force["rms"] - rms) <= 5.1e-5 and force["rating"] is None
        check(same, f"{name}: peak and root mean square of {axis} over the program")
        if "servo" in name:
            continue  # the velocities are those of the command
        # Velocities are rounded to 1e-4 mm/s.
        off = [(abs(force["values"][n] - f), abs(power["values"][n] - p))
               for n, f, p in forces(plan, a, period, "friction" in name)]
        worst = [max(one) for one in zip(*off)]
        check(len(off) > 100 and worst[0] < 1e-3 + MASS * 1e-7 / period and worst[1] < worst[0] + 1e-2,
              f"{name}: force and power of {axis} at {len(off)} samples, within {worst} N and W")
    if "supply" in name:
        total = curves["power_total", ""]
        each = [curves["power", axis]["values"] for axis in axes]
        off = max(abs(t - sum(parts)) for t, *parts in zip(total["values"], *each))
        check(total["bounds"] == [500, None] and max(total["values"]) <= 500 * (1 + 1e-6) and off < 2e-3,
              f"{name}: the sum of all axes within {off:.1g} W, at most {max(total['values'])} W")


def short_program(home):
    """So short that every sample is drawn."""
    code = home / "loads.ngc"
    code.write_text("G21 G90 G17 G64 P0.05 F6000\nG1 X40\nY30\nX5 Y10\nX40 Y12\nM2\n")
    return code


def with_loads(accdec, home, task):
    code = short_program(home)
    for name, lines in LOADS.items():
        file = home / "loads.toml"
        file.write_text(task.read_text() + lines)
        said, result = planned(accdec, home, code, file, "fixed")
        check(result, f"{name}: the command line plans it {said}".strip())
        refusal, profiles = planned(accdec, home, code, file, "profiles")
        program = Program(accdec, code, "--task", file, cwd=home)
        start = json.loads(program.ask("GET", program.path + "start")[1])["program"]
        program.end()
        fixed = [p for p in start["plans"] if p["plan"] == "fixed"]
        took = result["cycle_time_s"]
        check([p["cycle_time_s"] for p in fixed] == [took], f"{name}: the page has that plan, {took} s")
        loads_of_motion(name, fixed[0], result, 1e-3)
        if profiles:
            of_positions = [p["cycle_time_s"] for p in start["plans"] if p["plan"] == "profiles"]
            check(of_positions == [profiles["cycle_time_s"]], f"{name}: the page has plan profiles, {of_positions}")
            continue
        # The command line names the line of the task, too.
        why = re.sub(r"^\S+:\d+:\d+: ", "", refusal.removeprefix("accdec: ").removeprefix("error: ")).split(";")[0]
        check(why and start["others"] == [f"Plan profiles is not available for this task: {why}."],
              f"{name}: {start['others']}")


def binds_by_force(accdec, home, task):
    """Behind a servo the force binds where its curve is at the limit, and nowhere else."""
    code, file, servo = short_program(home), home / "loads.toml", LOADS["a servo"]
    file.write_text(task.read_text() + servo)
    peak = max(load["force_peak_N"] for load in planned(accdec, home, code, file, "fixed")[1]["axis_loads"])
    bound = peak * (1 + 1e-6)
    file.write_text(task.read_text() + servo.replace("force_max_N = 2000", f"force_max_N = {bound!r}"))
    program = Program(accdec, code, "--task", file, cwd=home)
    start = json.loads(program.ask("GET", program.path + "start")[1])["program"]
    program.end()
    plan, = start["plans"]
    each = [load["values"] for load in plan["loads"] if load["kind"] == "force"]
    uses = [max(map(abs, values)) / bound for values in zip(*each)]
    names = [start["limits"][i] if i >= 0 else start["other"] for i in plan["binds"]]
    full = {name for name, use in zip(names, uses) if use > 0.981}
    check("force" in full and start["other"] not in full, f"behind a servo, at {bound} N: {full} binds")
    low = min(use for name, use in zip(names, uses) if name == "force")
    check(low > 0.979, f"where the force binds, {low:.1%} of it are used")


def loads_on_paper(browser):
    """Force and power of an axis stand side by side, numbers of all charts are as large, an open corner is named."""
    browser.value("accdecProgram.state.set({ corner: '0' }), dispatchEvent(new Event('beforeprint'))")
    browser.page("Emulation.setEmulatedMedia", media="print")
    browser.page("Emulation.setDeviceMetricsOverride", width=717, height=1000, deviceScaleFactor=1, mobile=False)
    charts = browser.value("""[...document.querySelectorAll('#over-time section')].map((s) => {
        const canvas = s.querySelector('canvas'), box = canvas.getBoundingClientRect();
        return [s.querySelector('h2').textContent.split(' / ')[0], box.top, box.width / canvas.width]; })""")
    tops = {title: top for title, top, _ in charts}
    for axis in browser.value("accdecProgram.program.axes"):
        check(tops[f"force of {axis}"] == tops[f"power of {axis}"], f"force and power of {axis} are one row of paper")
    scales = [scale for *_, scale in charts]
    check(0.95 < min(scales) <= max(scales) < 1.05, f"charts are shrunk by {min(scales):.3f} to {max(scales):.3f}")
    said = browser.value("[document.querySelector('#corner').innerText,"
                         " getComputedStyle(document.querySelector('#corner'), '::after').content]")
    check(said[0].endswith("mm/min") and "open on the page" in said[1], f"{said[0]}: {said[1]}")
    browser.page("Emulation.setEmulatedMedia", media="")
    browser.page("Emulation.setDeviceMetricsOverride", width=1200, height=1000, deviceScaleFactor=1, mobile=False)
    browser.value("dispatchEvent(new Event('afterprint'))")


def draws_loads(accdec, browser, home, task):
    """A row of force and power for every axis, with their limits or the name of one that is off the scale."""
    file = home / "loads.toml"
    file.write_text(task.read_text() + LOADS["a supply"].replace("force_max_N = 2000", "force_max_N = 110"))
    program = Program(accdec, short_program(home), "--task", file, cwd=home)
    browser.open(program.address)
    wait(browser, "document.body.classList.contains('ready')", "the page of a machine with loads")
    said = browser.value("document.querySelector('#today').textContent")
    check(said == browser.value("accdecProgram.program.others[0]") and "not available" in said, said)
    titles = browser.value("[...document.querySelectorAll('#over-time h2')].map(h => h.textContent)")
    axes = browser.value("accdecProgram.program.axes")
    wanted = [f"{what} of {axis} / {unit}" for axis in axes for what, unit in (("force", "N"), ("power", "W"))]
    for title in [*wanted, "power of all axes / W"]:
        check(any(re.split("[,;]", t)[0] == title for t in titles), f"a drawing: {title}")
    shown = browser.value("""accdecProgram.charts.map((c) => [c.root.closest("section").querySelector("h2").textContent,
        c.scales.y.min, c.scales.y.max]).filter(([title]) => /^(force|power|velocity)/.test(title))""")
    bounds = {"force": 110, "velocity": 500, "power of all": 500, "power": 900}
    for title, low, high in shown:
        bound = next(b for kind, b in bounds.items() if title.startswith(kind))
        far = "\u00b1" if title.startswith(("force", "velocity")) else ""
        named = f"; limit {far}{bound}, off scale" in title
        check(named != (low <= bound <= high), f"{title}: from {low:.3g} to {high:.3g}, the limit is {bound}")
    check(len({"off scale" in title for title, *_ in shown}) == 2, "some limits are in the picture, others are named")
    loads_on_paper(browser)
    browser.open("about:blank")
    program.end()
