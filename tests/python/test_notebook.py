"""What notebooks show of tasks, results and programs, and what `help` says of the constructor."""
import ast
import inspect
import json
import os
import pathlib
import subprocess
import xml.etree.ElementTree as xml

import accdec

TASK = accdec.Task(title="a < b & c", sample_period=1e-3, axes={"acceleration_max": 6.0},
                   corners={"name": "A", "angle_deg": 95, "feed_in": 0.1, "error_max": 50e-6})


def parsed(html):
    return xml.fromstring(f"<div>{html}</div>")


def test_a_task_is_its_file():
    assert parsed(TASK._repr_html_()).findtext("pre") == TASK.to_toml()


def test_a_result_is_its_summary_and_figure():
    result = accdec.design(TASK)
    shown = parsed(result._repr_html_())
    assert shown.findtext("pre") == str(result)
    assert len(shown.findall("{http://www.w3.org/2000/svg}svg")) == 1
    nothing = accdec.design(TASK.replace(order_max=1), time_limit=5)
    assert nothing.x is None and parsed(nothing._repr_html_()).findtext("pre") == str(nothing)


def test_an_explanation_is_its_sentences():
    told = accdec.explain(TASK)
    assert parsed(told._repr_html_()).findtext("pre") == str(told)
    assert repr(told) == f'<accdec.Explanation "a < b & c": optimal, {len(told.gains)} gains, 0 remedies>'


def test_a_program_is_its_page(tmp_path):
    file = tmp_path / "square.ngc"
    file.write_text("G21 G90 G64 P0.05\nG1 X20 F3000\nY20\nM2\n")
    plan = accdec.program(file, {"sample_period": 1e-3, "axes": {"acceleration_max": 5.0}})
    assert repr(plan).startswith("<accdec.Program ")
    frame = parsed(plan._repr_html_()).find("iframe")
    assert frame.get("srcdoc").split() == plan.page().split()  # XML takes every white space in attributes for a blank
    assert frame.get("sandbox") == "allow-scripts"


def test_the_constructor_names_every_field():
    """Those of the stub, and every key of a task file."""
    signature = inspect.signature(accdec.Task)
    stub = ast.parse((pathlib.Path(accdec.__file__).parent / "_core.pyi").read_text())
    task, = (node for node in stub.body if isinstance(node, ast.ClassDef) and node.name == "Task")
    written = next(node for node in task.body if getattr(node, "name", "") == "__init__").args
    names = [*(a.arg for a in written.args[1:] + written.kwonlyargs), written.kwarg.arg]
    assert list(signature.parameters) == names
    schema = json.loads(subprocess.run([os.environ["ACCDEC_BINARY"], "schema", "task"], check=True, capture_output=True,
                                       text=True).stdout)["properties"]
    lists = {"axis": "axes", "corner": "corners", "mode": "modes"}
    keys = [key for key in [*schema, *schema["design"]["properties"]] if key not in ("design", "program")]
    assert {lists.get(key, key.removesuffix("_ms").removesuffix("_Hz")) for key in keys} <= set(names)


def test_every_method_has_a_signature():
    """inspect reads those of the compiled module from their texts."""
    for kind in (accdec.Task, accdec.Result, accdec.Program):
        for name in (name for name in dir(kind) if not name.startswith("_") and callable(getattr(kind, name))):
            inspect.signature(getattr(kind, name))
    assert list(inspect.signature(accdec.Task.read).parameters) == ["path", "program", "given"]
