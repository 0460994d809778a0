# SPDX-License-Identifier: GPL-3.0-or-later
"""The wheel: what pip builds and installs, and what is in it."""
import os
import subprocess
import sys
import zipfile

import nscdd

SOURCE, BUILD = os.environ["NSCDD_SOURCE"], os.environ["NSCDD_BUILD"]


def run(*command, **options):
    found = subprocess.run([str(part) for part in command], capture_output=True, text=True, timeout=500, **options)
    assert found.returncode == 0, found.stdout + found.stderr
    return found.stdout


def test_pip_installs_a_wheel_that_works_alone(tmp_path):
    """`pip install .` in a new environment, as docs/python.md says, and a radius from there; nothing is downloaded."""
    environment = tmp_path / "environment"
    run(sys.executable, "-m", "venv", "--system-site-packages", environment)
    python = environment / "bin" / "python"
    alone = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}
    alone.update(PIP_NO_INDEX="1", PIP_DISABLE_PIP_VERSION_CHECK="1", PIP_NO_CACHE_DIR="1", TMPDIR=str(tmp_path))
    run(python, "-m", "pip", "install", "--config-settings", f"build={BUILD}", SOURCE, env=alone, cwd=tmp_path)
    code = ("import nscdd; parts = nscdd.decompose(nscdd.generate('strip', grains=4), (2, 1)); "
            "print(nscdd.spectral_radius(nscdd.contraction(parts, 0.0)).value, nscdd.__file__)")
    radius, place = run(python, "-c", code, env=alone, cwd=tmp_path).split()
    assert abs(float(radius) - 0.6526756149155489) < 1e-14 and place.startswith(str(environment))
    libraries = run("ldd", os.path.join(os.path.dirname(place), "_core.cpython-311-x86_64-linux-gnu.so"), env=alone)
    assert str(environment) in [line for line in libraries.splitlines() if "libnscdd" in line][0]
    assert f"Version: {nscdd.__version__}\n" in run(python, "-m", "pip", "show", "nscdd", env=alone, cwd=tmp_path)


def test_the_wheel_has_what_belongs_in_it(tmp_path):
    sys.path.insert(0, os.path.join(SOURCE, "python"))
    try:
        import backend
    finally:
        sys.path.pop(0)
    before = os.getcwd()
    os.chdir(SOURCE)
    try:
        names = [backend.build_wheel(folder, {"build": BUILD}) for folder in (make(tmp_path, "a"), make(tmp_path, "b"))]
    finally:
        os.chdir(before)
    first, second = (open(tmp_path / folder / names[0], "rb").read() for folder in "ab")
    assert names[0] == names[1] and first == second
    with zipfile.ZipFile(tmp_path / "a" / names[0]) as wheel:
        files = wheel.namelist()
        metadata = wheel.read(f"nscdd-{nscdd.__version__}.dist-info/METADATA").decode()
        record = wheel.read(f"nscdd-{nscdd.__version__}.dist-info/RECORD").decode().splitlines()
    library = f"nscdd/libnscdd.so.{nscdd.__version__.rpartition('.')[0]}"
    assert {"nscdd/__init__.py", "nscdd/py.typed", "nscdd/_core.pyi", library} <= set(files)
    assert [line.split(",")[0] for line in record] == files
    assert f"Version: {nscdd.__version__}\n" in metadata and "Requires-Dist: scipy\n" in metadata


def make(parent, name):
    (parent / name).mkdir()
    return str(parent / name)
