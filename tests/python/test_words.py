"""Wrong values for every argument: messages have Python's names, units and types, not those of task files."""
import re

import pytest

import accdec

nan, inf = float("nan"), float("inf")
BASE = {"sample_period": 1e-3, "axes": {"acceleration_max": 6.0}, "corners": {"angle": 1.6, "feed_in": 0.1}}
WRONG = [nan, -1, -1e9, 0, 1.5, 1e9, 1e300, inf, True, "text", [1], [nan], {"a": 1}, [[1, 2]], None, 1j]
DICTS = ("axes", "corners", "modes", "machine", "controller", "filter", "baseline", "program")
# Arguments that another needs, so that the message is about the one that is tried.
BESIDE = {"axes": {"acceleration_max": 6.0}, "corners": {"angle": 1.6, "feed_in": 0.1},
          "modes": {"frequency": 40.0, "residual_max": 0.1}, "filter": {"kind": "boxcar", "order": 9},
          "baseline": {"kind": "boxcar", "order": 9}}
INSTEAD = {"direction_in": {"direction_in": [1, 0], "direction_out": [0, 1], "feed_in": 0.1},
           "direction_out": {"direction_in": [1, 0], "direction_out": [0, 1], "feed_in": 0.1},
           "residual_max_um": {"frequency": 40.0, "axis": "x", "residual_max_um": 3.0},
           "axis": {"frequency": 40.0, "axis": "x", "residual_max_um": 3.0}}
# Their names have a unit for Python, too: those of rotary axes, pairs of two units, and a second bound of a mode.
WITH_UNIT = re.compile(r"force_speed_N|torque_speed_N_m|residual_max_um|parameter_unit_ms|\w+_deg_s[23]?|"
                       r"\w+_N_m(_s)?|inertia_kg_m2")
UNIT = re.compile(r"\b\w+_(ms|us|Hz|um|mm|mm_min|mm_s|mm_s2|mm_s3|deg|kg|N|W|N_s_m|1_s|samples)\b")
FILE = re.compile(r"\[\[[a-z]|\[[a-z]+\]|in quotes|\btable|\barray|\bstring|an integer|fraction|boolean|\btrue\b"
                  r"|\bfalse\b|--|top level|/axis|/corner|unexpected|NoneType|incompatible|could not|object is not")


def known(name):
    """The keys that a dict may have, from the answer to one that it may not."""
    with pytest.raises(accdec.InputError) as refused:
        accdec.Task(**{**BASE, name: {**BESIDE.get(name, {}), "qqqqqqqq": 1}})
    names = str(refused.value).split("known here: ")[1].split(", ")
    assert len(names) == len(set(names)), names
    return names


def said(**fields):
    try:
        accdec.Task(**{**BASE, **fields})
    except (ValueError, TypeError) as error:
        return str(error)
    return None


def check(text, name, value):
    found = [m[0] for m in UNIT.finditer(text) if not WITH_UNIT.fullmatch(m[0])]
    assert not found and not FILE.search(text), f"{name} = {value!r}: {text}"


@pytest.mark.parametrize("name", [f for f in accdec._fields.FIELDS if f not in DICTS])
def test_arguments(name):
    words = [said(**{name: value}) for value in WRONG]
    for text, value in zip(words, WRONG):
        if text:
            check(text, name, value)
            assert f"`{name}`" in text or f'"{value}"' in text, f"{value!r}: {text}"  # an unknown family's own name
    assert sum(text is not None for text in words) >= 8


@pytest.mark.parametrize("table", DICTS)
def test_dicts(table):
    for value in [3, "text", [3], True]:
        text = said(**{table: value})
        if text:
            check(text, table, value)
            assert table in text
    for name in known(table):
        refused = 0
        for value in WRONG:
            fields = {**INSTEAD.get(name, BESIDE.get(table, {})), name: value}
            text = said(**{table: fields})
            if text:
                refused += 1
                check(text, f"{table} {name}", value)
                assert f"`{name}`" in text or value in (inf, None) or name in ("family", "name", "delays"), \
                    f"{value!r}: {text}"
        assert refused >= 5, name


def test_the_entry_is_named_where_there_are_several():
    axes = [{"name": "x", "acceleration_max": 6.0}, {"name": "y", "acceleration_max": 6.0}]
    for name, value in (("acceleration_max", -1.0), ("acceleration_max", nan), ("force_max", 3.0), ("servo_gain", "a")):
        assert "axes[1]" in said(axes=[axes[0], {**axes[1], name: value}])
    corners = [{"angle": 1.6, "feed_in": 0.1}, {"angle": 1.6, "feed_in": 0.1, "error_max": -1.0}]
    assert said(corners=corners).startswith("task: corners[1]: `error_max` = -1 is out of range; allowed is ")
    assert said(corners=[corners[0], {"angle": 1.6}]).startswith(
        "task: corners[1] needs `feed_in`; allowed is 0 < feed_in <= 166.66")
    assert said(axes=[axes[0], axes[0]]) == (
        'task: axes[1]: the name "x" is taken already (axes[0].name); names must differ')


def test_numbers_and_ranges_are_in_si():
    assert said(sample_period=None) == "task: a task needs `sample_period`; allowed is 1e-07 <= sample_period <= 1"
    assert said(corners={"angle": 1.6, "feed_in": 0.1, "delay": -1}) == (
        "task: `delay` = -1 is out of range; allowed is 0 <= delay <= 1000000")
    text = said(family="averages", length_step=1.5e-3)
    assert text.startswith("task: `length_step` = 1.5 ms is no multiple of the sample period")


def test_keys_as_in_files_stay_what_they_are():
    with pytest.raises(accdec.InputError, match="`sample_period_ms` = -1 .*; allowed is 0.0001 <= sample_period_ms"):
        accdec.Task(sample_period_ms=-1, corners=BASE["corners"])
    task = accdec.Task(**BASE)
    for key, named in (("corner.*.error_max", "`error_max` = -1 "), ("corner.*.error_max_um", "`error_max_um` = -1 ")):
        with pytest.raises(accdec.InputError, match=re.escape(named)):
            task.set(key, -1)


def test_limits_of_programs_are_an_argument():
    """As in [program] of a task file, in SI, and back from to_dict and replace."""
    task = accdec.Task(sample_period=1e-3, axes={"acceleration_max": 6.0}, program={"error_max": 2e-5})
    assert "error_max_um = 20" in task.to_toml()
    assert accdec.Task(**task.to_dict()) == task
    assert "error_max_um = 20" in task.replace(order_max=99).to_toml()
    assert task.replace(program={"error_max": 3e-5}).to_dict()["program"] == {"error_max_um": 30}
    both = accdec.Task(**BASE, program={"contour_max": 1e-5})
    assert len(both.corners) == 1 and "contour_max_um = 10" in both.to_toml()
    assert said(program={"error_max": -1.0}) == (
        "task: `error_max` = -1 is out of range; allowed is 0 <= error_max <= 10")


@pytest.mark.parametrize("fields, arguments, wanted", [
    ({"modes": {"frequency": 40, "residual_max": 0.1}}, {"plan": "free"}, 'modes.*plan="profiles"'),
    ({"axes": {"acceleration_max": 5.0, "servo_gain": 100}}, {"plan": "profiles"}, 'servo_gain.*plan="fixed"'),
    ({"axes": {"acceleration_max": 5.0, "servo_gain": 100}}, {"filter_bound": True}, "filter_bound.*servo_gain, "),
    ({"coefficient_bits": 16}, {}, "^coefficient_bits is for designs"),
    ({"axes": {}}, {"estimate": ["grbl"]}, "needs acceleration_max of axis")])
def test_refusals_of_programs(tmp_path, fields, arguments, wanted):
    file = tmp_path / "square.ngc"
    file.write_text("G21 G90 G64 P0.05\nG1 X20 F3000\nY20\nM2\n")
    with pytest.raises(ValueError, match=wanted) as refused:
        accdec.program(file, {"sample_period": 1e-3, "axes": {"acceleration_max": 5.0}, **fields}, **arguments)
    check(str(refused.value), "program", fields)


def test_answers_without_a_design():
    message = accdec.design(accdec.Task(**BASE).replace(order_max=3)).message
    assert "(order_max)" in message and "[design]" not in message
