"""Several corners that share a filter: the program's optimum of whole machine time against linear programs.

For a given order, delays, and a sample of each corner at which it is nearest, all limits are convex in the taps, so
`judge` decides whether there are taps. What costs less than the program's answer is a finite list of orders and delays;
every one of them is refuted.
"""
import itertools

import numpy as np

import judge
import model
import tasks
from corners import designed


class Costs:
    """What orders and delays cost, in samples: the machine's time, or that of the corners added up."""

    def __init__(self, task):
        design = task.get("design", {})
        self.weights = [c.get("weight", 1.0) for c in task["corner"]]
        self.per_tap = design.get("runs", 1.0) if design.get("objective", "cycle") == "cycle" else sum(self.weights)

    def __call__(self, order, delays):
        return self.per_tap * (order + 1) + sum(w * d for w, d in zip(self.weights, delays))


def width_rows(task, order, delays):
    """Rows |row b| <= 1 that hold if one in-position width gives these delays; None: no filter of this order has one.
    v_i p(d_i) <= w < v_j p(d_j - 1) for all corners, p(k) = sum b_i max(i - k, 0). So the faster never waits less."""
    feeds, rows = [c["feed_in_mm_min"] for c in task["corner"]], [np.zeros((0, order + 1))]
    if "controller" in task:
        for (v, d), (u, e) in itertools.permutations(zip(feeds, delays), 2):
            if v >= u and d < e or max(d, e) > order:
                return None
            row = v * np.maximum(np.arange(order + 1) - d, 0) - u * np.maximum(np.arange(order + 1) - e + 1, 0)
            if e > 0 and u != v:
                rows.append(1.0 + row[None] / np.abs(row).max())
    return np.vstack(rows)


class Order:
    """All corners of a task at one order: which delays and samples each allows by itself, and together."""

    def __init__(self, task, order):
        self.task, self.order, self.motions, self.alone = task, order, {}, {}

    def motion(self, j, delay):
        if (j, delay) not in self.motions:
            corner = self.task["corner"][j]
            motion = model.unit_motions(self.task, corner, self.order, delay)
            self.motions[j, delay] = motion, model.linear_rows(self.task, corner, motion), corner["error_max_um"] * 1e-6
        return self.motions[j, delay]

    def samples(self, j, delay):
        """Samples at which corner j may be within its tolerance with this delay, were it alone."""
        if (j, delay) not in self.alone:
            motion, rows, tolerance = self.motion(j, delay)
            found = []
            for k in range(min(delay, self.order), max(delay, self.order) + 1):
                error = judge.smallest_error(rows, [], [p[k] for p in motion.position], tolerance)
                if error is None:
                    break  # the limits alone exclude this delay
                if error <= tolerance * (1.0 + judge.MARGIN):
                    found.append(k)
            self.alone[j, delay] = found
        return self.alone[j, delay]

    def together(self, delays, nearest, slack):
        """Whether one filter holds all limits and brings the first corners within their tolerances at the samples
        `nearest`; limits and tolerances widened by `slack` (a share)."""
        motions = [self.motion(j, d) for j, d in enumerate(delays)]
        widths = width_rows(self.task, self.order, delays)
        rows = np.vstack([widths, *(rows for _, rows, _ in motions)]) / (1.0 + slack)
        ends = [
            ([p[k] for p in motion.position], tolerance * (1.0 + slack))
            for (motion, _, tolerance), k in zip(motions, nearest)
        ]
        # In units of the tolerance: in metres it would be no more than a thousand times what HiGHS lets pass.
        cones = [(judge.plane(position)[None] / tolerance, 1.0) for position, tolerance in ends[1:]]
        error = judge.smallest_error(rows, cones, *ends[0])
        return error is not None and error <= ends[0][1]

    def holds(self, delays, nearest=()):
        """True, False, or None where the margin decides; `nearest`: samples chosen for the first corners."""
        if len(nearest) == len(delays):
            return True if self.together(delays, nearest, -judge.MARGIN) else None
        answer = False
        for k in self.samples(len(nearest), delays[len(nearest)]):
            if self.together(delays, nearest + (k,), judge.MARGIN):
                found = self.holds(delays, nearest + (k,))
                if found:
                    return True
                answer = None if found is None else answer
        return answer


def cheaper(task, bound):
    """Orders and delays that cost less than `bound`, each corner by itself within its limits."""
    costs = Costs(task)
    for order in range(1, task["design"]["order_max"] + 1):
        at, zero = Order(task, order), [0] * len(task["corner"])
        left = bound * (1.0 - 1e-9) - costs(order, zero)
        if left <= 0.0:
            return
        # From d = N + 2 on more delay changes nothing.
        lists = []
        for j, weight in enumerate(costs.weights):
            most = min(order + 2, int(left / weight))
            lists.append([d for d in range(most + 1) if at.samples(j, d)])
            if not lists[-1]:
                break
            left -= weight * lists[-1][0]
        else:
            for delays in itertools.product(*lists):
                possible = width_rows(task, order, delays) is not None
                if possible and costs(order, delays) < bound * (1.0 - 1e-9):
                    yield at, delays


def draw(rng):
    """Small, and mostly of two corners: the judge solves hundreds of linear programs for two, thousands for three."""
    task = tasks.draw(rng, "several", longest=5)
    if rng.random() < 0.75:
        del task["corner"][2:]
    task["design"] = {
        "objective": rng.choice(["cycle", "cycle", "cycle", "corner"]),
        "runs": rng.choice([1.0, 2.5, 7.0]),
        "order_max": 12,
    }
    if rng.random() < 0.3:
        task["controller"] = {"delays": ["in-position"]}
    return task


def judge_result(attack, task, result, *files):
    costs, period = Costs(task), task["sample_period_ms"] / 1e3
    order, delays = result["filter"]["order"], [c["delay_samples"] for c in result["corners"]]
    runs = task["design"]["runs"]
    times = {
        "cycle_time_s": runs * (order + 1) + sum(w * d for w, d in zip(costs.weights, delays)),
        "corner_time_s": sum(w * (order + 1 + d) for w, d in zip(costs.weights, delays)),
    }
    for name, samples in times.items():
        if abs(result[name] - period * samples) > 1e-9 * period * samples:
            attack.fail(f"{name} is {result[name]}, not {period * samples}", *files)
    attack.count("optima judged")
    if Order(task, order).holds(delays) is False:
        attack.fail(f"the judge finds no filter of N = {order} and delays {delays}, the program did", *files)
    for at, less in cheaper(task, costs(order, delays)):
        attack.count("cheaper delays refuted")
        found = at.holds(less)
        if found is None:
            attack.count("undecided by the judge")
        elif found:
            attack.fail(
                f"optimal with N = {order} and delays {delays}, but N = {at.order} and {less} cost less", *files
            )


def run(attack):
    for task, result, files in designed(attack, draw):
        if result["status"] == "optimal":
            try:
                judge_result(attack, task, result, *files)
            except judge.Unsolved:
                attack.count("undecided by the judge")
