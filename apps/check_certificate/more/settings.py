"""Settings that a result names: a member of their family has its taps."""
from functools import reduce

import claim
import families
from enclosure import exact, number, refuse_if
from more.widening import widens
from problem import ROUNDING, convolved


def made_by(said, problem, task, taps):
    """Filters that are all the recorded one: of a member of the family, and for averages of the values to enter."""
    family = said["family"]
    if family == "taps":
        return [[exact(said["filter"]["taps"])]]
    members = map(exact, families.LISTS[family](families.Members(problem, task.get("design", {}), len(taps.lo))))
    if family != "averages":
        return [members]
    units = task.get("controller", {}).get("parameter_unit_ms", [1] * len(said["values"]))
    refuse_if(len(units) != len(said["values"]), "the settings are not one value a stage")
    lengths = (max(1, round(number(value["value"]) * number(unit) / 1000 / problem.period))
               for value, unit in zip(said["values"], units))
    return [members, [reduce(convolved, (exact([1] * length) for length in lengths), exact([1]))]]


@widens(claim, "recorded")
def recorded(narrow, result, problem):
    found, said = narrow(result, problem), result.get("settings")
    if said is None:
        return found
    taps = exact(result["filter"]["taps"])

    def same(x):
        return len(x.lo) == len(taps.lo) and not abs(x / x.total() - taps) > ROUNDING

    ways = made_by(said, problem, result["task"], taps)
    refuse_if(not all(any(map(same, way)) for way in ways), "the taps are not those of the settings")
    return found
