"""Makes the wheel: CMake builds and installs the module, patchelf ties it to the libraries that the wheel carries. The
source distribution has all that this needs.

The hooks are PEP 517's. `--config-settings build=FOLDER` takes what a configured build folder has; without it, CMake
builds in build/wheel.
"""
import io
import os
import pathlib
import platform
import re
import shutil
import subprocess
import sys
import sysconfig
import tarfile
import tempfile
import tomllib

from wheel.wheelfile import WheelFile

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parents[1]
SOURCES = ("CMakeLists.txt", "CMakePresets.json", "LICENSE", "README.md", "lib", "apps", "problems")  # of the module
# Every Linux with this C library has them (PEP 600); all others come along.
EVERYWHERE = re.compile(r"(ld-linux.*|libc|libm|libdl|librt|libpthread|libgcc_s|libstdc\+\+|libz)\.so(\.\d+)*")


def run(*command, **more):
    return subprocess.run([str(part) for part in command], check=True, text=True, **more)


def version():
    """Of the whole project; it stands in the top CMakeLists.txt."""
    return re.search(r"project\(accdec VERSION ([\d.]+)", (ROOT / "CMakeLists.txt").read_text())[1]


def build_folder(settings):
    if "build" in settings:
        return pathlib.Path(settings["build"]).resolve()
    if missing := [part for part in SOURCES if not (ROOT / part).exists()]:
        raise SystemExit(f"{ROOT}: {missing[0]} is missing: the module is built from the whole project around "
                         "apps/python, or from its source distribution")
    folder = ROOT / "build" / "wheel"
    run("cmake", "--preset", "release", "-B", folder, "-DACCDEC_PYTHON=ON", "-DACCDEC_BUILD_TESTS=OFF",
        "-DACCDEC_BUILD_BENCHMARKS=OFF", f"-DPython_EXECUTABLE={sys.executable}", cwd=ROOT)
    run("cmake", "--build", folder, "--target", "accdec_python")
    return folder


def installed(folder, prefix):
    """The package and the modules of solvers as CMake installs them: (package, modules)."""
    for component in ("python", "solvers"):
        run("cmake", "--install", folder, "--prefix", prefix, "--component", component, "--strip", stdout=sys.stderr)
    core = next(prefix.rglob("_core*.so"))
    if not core.name.endswith(sysconfig.get_config_var("EXT_SUFFIX")):
        raise SystemExit(f"{folder}: {core.name} is not for {sys.executable}")
    return core.parent, sorted(prefix.rglob("accdec-*.so"))


def foreign(files):
    """Paths of the libraries that these need, by name."""
    found = {}
    for file in files:
        for line in run("ldd", file, capture_output=True).stdout.splitlines():
            name, _, path = (part.strip() for part in line.partition("=>"))
            if "not found" in path:
                raise SystemExit(f"{file}: {line.strip()}")
            if path and not EVERYWHERE.fullmatch(name):
                found[name] = pathlib.Path(path.split(" (")[0])
    return found


def bundle(package, modules, libraries):
    """Copies libraries and modules into the folder `libraries`, under names that no other package loads."""
    needed = foreign([*package.glob("_core*.so"), *modules])
    renamed = {name: f"accdec-{name}" for name in needed}
    for name, path in needed.items():
        shutil.copy(path, libraries / renamed[name])
        run("patchelf", "--set-soname", renamed[name], libraries / renamed[name])
    for module in modules:
        shutil.copy(module, libraries)
    names = [part for pair in renamed.items() for part in ("--replace-needed", *pair)]
    for file in [*libraries.iterdir(), *package.glob("_core*.so")]:
        file.chmod(0o755)
        run("patchelf", *names, file)  # together with --set-rpath, patchelf 0.14 mixes up the names
        run("patchelf", "--set-rpath", "$ORIGIN" if file.parent == libraries else f"$ORIGIN/../{libraries.name}", file)
    return sorted(needed.values())


def licences(paths, folder):
    """The project's licence, and what Debian says of the libraries' authors and terms, a file a package."""
    shutil.copy(ROOT / "LICENSE", folder)
    for path in paths if shutil.which("dpkg") else ():
        # If /lib is a link to /usr/lib, packages know some files by the short name.
        for place in (path.resolve(), str(path.resolve()).removeprefix("/usr"), path):
            owner = subprocess.run(["dpkg", "-S", str(place)], capture_output=True, text=True).stdout.split(":")[0]
            copyright = pathlib.Path("/usr/share/doc", owner, "copyright")
            if owner and copyright.exists():
                shutil.copy(copyright, folder / owner)
                break


def metadata():
    project = tomllib.loads((HERE / "pyproject.toml").read_text())["project"]
    extras = [(extra, need) for extra, needs in project["optional-dependencies"].items() for need in needs]
    return "\n".join([
        "Metadata-Version: 2.1", f"Name: {project['name']}", f"Version: {version()}",
        f"Summary: {project['description']}", f"Requires-Python: {project['requires-python']}",
        *(f"Requires-Dist: {need}" for need in project["dependencies"]),
        *(f"Provides-Extra: {extra}" for extra in project["optional-dependencies"]),
        *(f"Requires-Dist: {need}; extra == '{extra}'" for extra, need in extras),
        "Description-Content-Type: text/markdown", "", (HERE / "README.md").read_text()])


def tag():
    """The C library built with is the oldest that is promised, as libstdc++ of the same age is needed."""
    python = f"cp{sys.version_info.major}{sys.version_info.minor}"
    libc = platform.libc_ver()[1].replace(".", "_")
    return f"{python}-{python}-manylinux_{libc}_{platform.machine()}"


def build_wheel(wheel_directory, config_settings=None, metadata_directory=None):
    if not shutil.which("patchelf"):
        raise SystemExit("the wheel needs the program patchelf (apt-get install patchelf)")
    folder = build_folder(config_settings or {})
    with tempfile.TemporaryDirectory() as scratch:
        content = pathlib.Path(scratch, "wheel")
        information = content / f"accdec-{version()}.dist-info"
        libraries = content / "accdec.libs"
        for made in (information / "licenses", libraries):
            made.mkdir(parents=True)
        package, modules = installed(folder, pathlib.Path(scratch, "prefix"))
        shutil.copytree(package, content / "accdec")
        licences(bundle(content / "accdec", modules, libraries), information / "licenses")
        (information / "METADATA").write_text(metadata())
        (information / "WHEEL").write_text("Wheel-Version: 1.0\nGenerator: accdec\nRoot-Is-Purelib: false\n"
                                           f"Tag: {tag()}\n")
        name = f"accdec-{version()}-{tag()}.whl"
        with WheelFile(os.path.join(wheel_directory, name), "w") as wheel:
            wheel.write_files(str(content))
    return name


def build_sdist(sdist_directory, config_settings=None):
    name = f"accdec-{version()}"
    description = (HERE / "pyproject.toml").read_text().replace('backend-path = ["."]', 'backend-path = ["apps/python"]')
    with tarfile.open(os.path.join(sdist_directory, f"{name}.tar.gz"), "w:gz", format=tarfile.PAX_FORMAT) as archive:
        for part in SOURCES:
            archive.add(ROOT / part, f"{name}/{part}", filter=lambda f: None if f.name.endswith("__pycache__") else f)
        for file, text in (("PKG-INFO", metadata()), ("pyproject.toml", description)):
            entry = tarfile.TarInfo(f"{name}/{file}")
            entry.size = len(text.encode())
            archive.addfile(entry, io.BytesIO(text.encode()))
    return f"{name}.tar.gz"
