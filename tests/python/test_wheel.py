"""The wheel, made by pip and by build: it designs in a venv without the libraries that it was built with."""
import os
import pathlib
import re
import subprocess
import sys
import zipfile

import pytest

SOURCE = pathlib.Path(__file__).parents[2] / "apps" / "python"
BUILD = f"build={os.environ['ACCDEC_BUILD']}"
ENVIRONMENT = {k: v for k, v in os.environ.items() if k not in ("PYTHONPATH", "LD_LIBRARY_PATH")}
DESIGNS = """
import accdec, ctypes, pathlib
task = {"sample_period": 1e-3, "axes": {"acceleration_max": 6.0},
        "corners": {"angle_deg": 95, "feed_in": 0.1, "error_max": 50e-6}}
print(accdec.__file__)
print(accdec.design(task).outcome)
for solver in ("ipopt", "nlopt-slsqp", "ceres-al"):
    print(solver, accdec.design(task, solver=solver, time_limit=300).success)  # 2 s of processor time for ceres-al
for library in pathlib.Path(accdec.__file__).parents[1].glob("accdec.libs/*"):
    ctypes.CDLL(str(library))  # none misses another
loaded = {line.split()[-1] for line in open("/proc/self/maps") if "/" in line}
print(*(path for path in loaded if any(name in path for name in ("ipopt", "nlopt", "Clp", "cholmod", "tbb", "fmt"))))
"""


def run(*command, **more):
    done = subprocess.run(list(map(str, command)), env=ENVIRONMENT, capture_output=True, text=True, **more)
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


@pytest.fixture(scope="module")
def wheel(tmp_path_factory):
    folder = tmp_path_factory.mktemp("wheel")
    run(sys.executable, "-m", "build", "--no-isolation", "-C", BUILD, "--outdir", folder, SOURCE)
    return next(folder.glob("*.whl"))


@pytest.fixture(scope="module")
def python(tmp_path_factory):
    """Of a venv that pip has installed the module into, from its source folder."""
    venv = tmp_path_factory.mktemp("venv")
    run(sys.executable, "-m", "venv", "--system-site-packages", venv)
    run(venv / "bin" / "pip", "install", "--no-index", "--no-build-isolation", "--config-settings", BUILD, SOURCE)
    return venv / "bin" / "python"


def test_says_what_it_runs_on(wheel):
    """manylinux_x_y: C libraries from x.y on. A symbol of a later one would be refused there."""
    libc = re.search(r"-manylinux_2_(\d+)_x86_64\.whl", wheel.name)[1]
    with zipfile.ZipFile(wheel) as content:
        content.extractall(wheel.parent / "content")
    needed = set()
    for file in wheel.parent.rglob("*.so*"):
        needed |= set(map(int, re.findall(r"Name: GLIBC_2\.(\d+)", run("readelf", "-VW", file))))
    assert needed and max(needed) <= int(libc)


def test_has_the_licences_of_what_it_carries(wheel):
    with zipfile.ZipFile(wheel) as content:
        names = content.namelist()
    assert any(re.search(r"licenses/LICENSE$", name) for name in names)
    for library in ("ipopt", "nlopt", "libclp", "cholmod"):
        assert any("licenses/" in name and library in name for name in names), library


def hidden(python):
    """Libraries of this system under the names of those that the wheel carries, but for those that NumPy needs."""
    run(python, "-c", "import accdec")
    libraries, = python.parents[1].glob("lib/python3*/site-packages/accdec.libs")
    names = {file.name.removeprefix("accdec-") for file in libraries.iterdir()}
    numpy = run(python, "-c", "import numpy, pandas; print(open('/proc/self/maps').read())")
    system = re.findall(r"=> (/\S+)", run("/sbin/ldconfig", "-p"))
    found = {str(pathlib.Path(path).resolve()) for path in system if pathlib.Path(path).name in names}
    return sorted(path for path in found if path not in numpy)


def test_designs_without_the_libraries_it_was_built_with(python):
    if subprocess.run(["unshare", "-rm", "true"], capture_output=True).returncode != 0:
        pytest.skip("needs a mount namespace")
    files = hidden(python)
    assert len(files) > 10 and any("ipopt" in file for file in files), files
    hide = [*(f"mount --bind /dev/null {file}" for file in files),
            *(f"mount -t tmpfs none {folder}" for folder in ("/usr/include", os.environ["ACCDEC_BUILD"]))]
    said = run("unshare", "-rm", "sh", "-ec", "; ".join([*hide, 'exec "$0" -c "$1"']), python, DESIGNS, cwd="/")
    lines = said.splitlines()
    site = str(python.parents[1])
    assert lines[0].startswith(site) and lines[1] == "optimal"
    assert lines[2:5] == ["ipopt True", "nlopt-slsqp True", "ceres-al True"], said
    assert all(path.startswith(site) for path in lines[-1].split()), said


def test_a_folder_without_its_project_is_refused(tmp_path):
    alone = tmp_path / "alone"
    alone.mkdir()
    (alone / "wheel_backend.py").write_text((SOURCE / "wheel_backend.py").read_text())
    done = subprocess.run([sys.executable, "-c", "import wheel_backend; wheel_backend.build_folder({})"], cwd=alone,
                          capture_output=True, text=True)
    assert done.returncode != 0 and "CMakeLists.txt is missing" in done.stderr and "Traceback" not in done.stderr
