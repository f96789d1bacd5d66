"""The module as `cmake --install` puts it into a prefix, imported from there by a fresh interpreter."""
import os
import pathlib
import subprocess
import sys

import accdec


def run(code, path, **more):
    environment = {**os.environ, "PYTHONPATH": str(path)}
    return subprocess.run([sys.executable, "-c", code], env=environment, capture_output=True, text=True, **more)


def test_an_installed_module_is_whole(tmp_path):
    subprocess.run(["cmake", "--install", os.environ["ACCDEC_BUILD"], "--prefix", tmp_path, "--component", "python"],
                   check=True, capture_output=True)
    package, = tmp_path.glob("lib/python3*/dist-packages/accdec")
    here = pathlib.Path(accdec.__file__).parent
    assert {p.name for p in package.iterdir()} == {p.name for p in here.iterdir() if p.name != "__pycache__"}
    assert not any(p.is_symlink() for p in package.iterdir())
    said = run("import accdec, sys; print(accdec.__file__); print(accdec.design({'sample_period': 1e-3, 'corners': "
               "{'angle_deg': 90, 'feed_in': 0.1}}).outcome)", package.parent)
    assert said.stdout.split() == [str(package / "__init__.py"), "optimal"], said.stderr


def test_importing_needs_numpy_alone():
    """SciPy and pandas are imported where they are used; nothing needs matplotlib."""
    said = run("import sys, accdec; print(sorted({'scipy', 'pandas', 'matplotlib'} & set(sys.modules)))",
               pathlib.Path(accdec.__file__).parents[1])
    assert said.stdout.strip() == "[]", said.stderr
