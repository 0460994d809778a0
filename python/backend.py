# SPDX-License-Identifier: GPL-3.0-or-later
"""Builds the wheel of nscdd by CMake: the hooks of PEP 517, which pip and other frontends call at the root of the tree.

`pip install .` configures and builds in build/wheel. `pip install --config-settings build=build/release .` takes what
is built in that folder already, which must have been configured with NSCDD_PYTHON=ON.
"""
import base64
import hashlib
import os
import re
import subprocess
import sys
import sysconfig
import tarfile
import tempfile
import tomllib
import zipfile

MOMENT = (1980, 1, 1, 0, 0, 0)  # of every file in the wheel: equal builds give equal bytes


def _project():
    with open("pyproject.toml", "rb") as stream:
        project = tomllib.load(stream)["project"]
    with open("CMakeLists.txt", encoding="utf-8") as stream:
        project["version"] = re.search(r"project\(nscdd VERSION ([0-9.]+)", stream.read()).group(1)
    return project


def _metadata(project):
    lines = ["Metadata-Version: 2.1", f"Name: {project['name']}", f"Version: {project['version']}",
             f"Summary: {project['description']}", f"License: {project['license']['text']}",
             f"Requires-Python: {project['requires-python']}"]
    lines += [f"Requires-Dist: {name}" for name in project["dependencies"]]
    for extra, names in project["optional-dependencies"].items():
        lines.append(f"Provides-Extra: {extra}")
        lines += [f'Requires-Dist: {name} ; extra == "{extra}"' for name in names]
    with open(project["readme"], encoding="utf-8") as stream:
        return "\n".join(lines + ["Description-Content-Type: text/markdown", "", stream.read()])


def _tag():
    interpreter = f"cp{sys.version_info.major}{sys.version_info.minor}"
    return f"{interpreter}-{interpreter}-{re.sub('[-.]', '_', sysconfig.get_platform())}"


def _built(settings):
    """The build folder, with the module built in it."""
    folder = (settings or {}).get("build")
    if folder is None:
        folder = os.path.join("build", "wheel")
        subprocess.run(["cmake", "--preset", "release", "-B", folder, "-DNSCDD_TESTS=OFF", "-DNSCDD_PYTHON=ON",
                        f"-DNSCDD_PYTHON_INTERPRETER={sys.executable}"], check=True)
    subprocess.run(["cmake", "--build", folder, "--target", "nscdd_python"], check=True)
    return folder


def _files(folder):
    """(name, path) of every file below a folder, sorted. A wheel has no links: the library has the name alone by which
    it is looked for, which is a link here."""
    found = [os.path.join(place, name) for place, _, names in os.walk(folder) for name in names]
    behind_links = {os.path.realpath(path) for path in found if os.path.islink(path)}
    return sorted((os.path.relpath(path, folder), path) for path in found
                  if os.path.islink(path) or os.path.realpath(path) not in behind_links)


def build_wheel(wheel_directory, config_settings=None, metadata_directory=None):
    """Builds the wheel in that folder; returns its name."""
    project, tag = _project(), _tag()
    name = f"{project['name']}-{project['version']}"
    wheel = f"{name}-{tag}.whl"
    with tempfile.TemporaryDirectory() as staging:
        subprocess.run(["cmake", "--install", _built(config_settings), "--prefix", staging, "--component", "wheel",
                        "--strip"], check=True)
        contents = [(file, open(path, "rb").read()) for file, path in _files(staging)]
    generator = f"Wheel-Version: 1.0\nGenerator: nscdd\nRoot-Is-Purelib: false\nTag: {tag}\n"
    contents += [(f"{name}.dist-info/METADATA", _metadata(project).encode()),
                 (f"{name}.dist-info/WHEEL", generator.encode())]
    with open("LICENSE", "rb") as stream:
        contents.append((f"{name}.dist-info/LICENSE", stream.read()))
    record = ""
    for file, data in contents:
        digest = base64.urlsafe_b64encode(hashlib.sha256(data).digest()).rstrip(b"=").decode()
        record += f"{file},sha256={digest},{len(data)}\n"
    record += f"{name}.dist-info/RECORD,,\n"
    contents.append((f"{name}.dist-info/RECORD", record.encode()))
    with zipfile.ZipFile(os.path.join(wheel_directory, wheel), "w", zipfile.ZIP_DEFLATED) as archive:
        for file, data in contents:
            entry = zipfile.ZipInfo(file, MOMENT)
            entry.compress_type = zipfile.ZIP_DEFLATED
            entry.external_attr = (0o755 if ".so" in file else 0o644) << 16
            archive.writestr(entry, data)
    return wheel


def build_sdist(sdist_directory, config_settings=None):
    """Packs the files that git tracks; returns the name of the archive."""
    project = _project()
    name = f"{project['name']}-{project['version']}"
    tracked = subprocess.run(["git", "ls-files", "-z"], check=True, capture_output=True).stdout.decode()
    with tarfile.open(os.path.join(sdist_directory, f"{name}.tar.gz"), "w:gz", format=tarfile.PAX_FORMAT) as archive:
        for file in filter(None, tracked.split("\0")):
            archive.add(file, f"{name}/{file}", recursive=False)
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "PKG-INFO")
            with open(path, "w", encoding="utf-8") as stream:
                stream.write(_metadata(project))
            archive.add(path, f"{name}/PKG-INFO")
    return f"{name}.tar.gz"
