# SPDX-License-Identifier: GPL-3.0-or-later
"""The package as others meet it: its type hints and its documentation."""
import inspect
import os
import subprocess
import sys

import nscdd

BUILD = os.environ["NSCDD_BUILD"]


def run(*command, **options):
    found = subprocess.run([str(part) for part in command], capture_output=True, text=True, timeout=500, **options)
    assert found.returncode == 0, found.stdout + found.stderr
    return found.stdout


def public():
    """(name, object) of everything public, the members of classes included."""
    for name in nscdd.__all__:
        one = getattr(nscdd, name)
        yield name, one
        if inspect.isclass(one) and one is not nscdd.Error:
            for member, value in vars(one).items():
                if not member.startswith("_") and (callable(value) or isinstance(value, property)):
                    yield f"{name}.{member}", value


def test_everything_public_is_described():
    bare = {"Decomposition.grains", "Decomposition.contacts", "FrictionSolution.converged"}
    without = {name for name, one in public() if not (getattr(one, "__doc__", None) or "").strip()}
    assert without - bare == set()
    assert nscdd.__version__.count(".") == 2


def test_type_hints_hold_for_the_compiled_module(tmp_path):
    """mypy accepts the package, and its stubtest finds every name and signature of the stub in the module."""
    run(sys.executable, "-m", "mypy", "--strict", "--ignore-missing-imports", "--allow-subclassing-any",
        "--allow-any-generics", "--no-warn-return-any", "--cache-dir", tmp_path, "-p", "nscdd",
        env=dict(os.environ, MYPYPATH=os.path.join(BUILD, "python")), cwd=tmp_path)
    (tmp_path / "mypy.ini").write_text("[mypy]\nignore_missing_imports = True\n")
    # Classes of pybind11 have a metaclass of their own, and those that are never made by users take any arguments.
    (tmp_path / "pybind11.txt").write_text(r"nscdd\._core\.[A-Z]\w*(\.__init__)?" + "\n")
    run(sys.executable, "-m", "mypy.stubtest", "nscdd._core", "--mypy-config-file", "mypy.ini", "--allowlist",
        "pybind11.txt", cwd=tmp_path, env=dict(os.environ, MYPYPATH=os.path.join(BUILD, "python")))


def test_a_user_is_told_of_wrong_types(tmp_path):
    (tmp_path / "use.py").write_text("import nscdd\nparts = nscdd.decompose(nscdd.generate('strip'), (2, 1))\n"
                                     "rho: str = nscdd.spectral_radius(nscdd.contraction(parts, 1.0)).value\n")
    found = subprocess.run([sys.executable, "-m", "mypy", "--ignore-missing-imports", "--cache-dir",
                            tmp_path / "cache", "use.py"], cwd=tmp_path, capture_output=True, text=True,
                           env=dict(os.environ, MYPYPATH=os.path.join(BUILD, "python")), timeout=500)
    assert 'expression has type "float", variable has type "str"' in found.stdout, found.stdout + found.stderr
