#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Checks what a release says of itself against the one place that knows it.

usage: release.py SOURCE [PROGRAM]

SOURCE is the root of the tree, PROGRAM the nscdd that was built from it. Checked are
  - the version: that of CMakeLists.txt, wherever another file has to name it, and in `nscdd --version`;
  - the day of the release: that of CHANGELOG.md, wherever another file has to name it;
  - CITATION.cff (version 1.2.0 of its format) and codemeta.json (version 3.0): keys, and one description;
  - debian/: what it builds with is what tools/packages.txt has, every package has its files and every test its script;
  - the recipes of packaging/: what they build with is what CMakeLists.txt looks for;
  - .github/ISSUE_TEMPLATE/: each has a name, what it is about, and asks for the version and for a command.
"""
import ast
import datetime
import json
import os
import re
import subprocess
import sys

import yaml

# What the build looks for (find_package), and its names where the recipes are for.
NAMES = {  # CMake: Spack, Guix, codemeta
    "ARPACK": ("arpack-ng", "arpack-ng", "ARPACK-NG"),
    "BLAS": ("openblas", "openblas", "BLAS"),
    "Eigen3": ("eigen", "eigen", "Eigen"),
    "GSL": ("gsl", "gsl", "GSL"),
    "HDF5": ("hdf5", "hdf5", "HDF5"),
    "LAPACKE": ("openblas", "openblas", "LAPACKE"),
    "METIS": ("metis", "metis", "METIS"),
    "SuiteSparse": ("suite-sparse", "suitesparse", "SuiteSparse"),
    "TBB": ("intel-oneapi-tbb", "onetbb", "TBB"),
    "fmt": ("fmt", "fmt-9", "fmt"),
    "nlohmann_json": ("nlohmann-json", "nlohmann-json", "nlohmann-json"),
    "tomlplusplus": ("tomlplusplus", "tomlplusplus", "toml++"),
}
# The terms of schema.org and of CodeMeta 3.0 that codemeta.json may have.
CODEMETA = {
    "@context", "@type", "applicationCategory", "author", "buildInstructions", "codeRepository", "contributor",
    "dateCreated", "dateModified", "datePublished", "description", "developmentStatus", "downloadUrl", "funder",
    "identifier", "issueTracker", "keywords", "license", "maintainer", "name", "operatingSystem",
    "programmingLanguage", "readme", "referencePublication", "releaseNotes", "softwareHelp", "softwareRequirements",
    "softwareSuggestions", "url", "version"}


class Tree:
    """The files of the source tree, and what is wrong with them."""

    def __init__(self, root):
        self.root, self.wrong = root, []

    def path(self, name):
        return os.path.join(self.root, name)

    def text(self, name):
        with open(self.path(name), encoding="utf-8") as stream:
            return stream.read()

    def expect(self, name, what, expected, met):
        if expected != met:
            self.wrong.append(f"{name}: {what}: expected {expected!r}, met {met!r}")

    def expect_all(self, name, what, pattern, expected):
        """Every match of the pattern is the expected text, and there is one."""
        found = re.findall(pattern, self.text(name), re.MULTILINE)
        self.expect(name, what, [expected], sorted(set(found)))


def check_version(tree, version):
    minor = version.rpartition(".")[0]
    tree.expect_all("CITATION.cff", "version", r"^version: (.*)$", version)
    tree.expect_all("codemeta.json", "version", r'^  "version": "(.*)"', version)
    tree.expect("debian/changelog", "version of the first entry", version,
                re.match(r"nscdd \((.*?)\)", tree.text("debian/changelog")).group(1))
    tree.expect_all("debian/control", "library in a package's name", r"libnscdd(?:-mpi)?(\d[\d.]*)", minor)
    tree.expect_all("tests/consumer/CMakeLists.txt", "find_package", r"find_package\(nscdd ([\d.]+)", minor)
    tree.expect_all("packaging/spack/package.py", "version", r'^    version\("(.*)"\)', version)
    tree.expect_all("packaging/spack/package.py", "command", r"nscdd@([\d.]+)", version)
    tree.expect_all("packaging/guix/nscdd.scm", "version", r'^  \(version "(.*)"\)', version)
    tree.expect_all("packaging/container/Containerfile", "tag", r"nscdd:([\d.]+)", version)
    tree.expect_all("packaging/container/Containerfile", "library", r"libnscdd([\d.]+)_", minor)
    page = "docs/release.md"
    tree.expect_all(page, "tag", r"\bv(\d+\.\d+\.\d+)", version)
    tree.expect_all(page, "project() of CMakeLists.txt", r"project\(nscdd VERSION ([\d.]+)", version)
    tree.expect_all(page, "heading of CHANGELOG.md", r"/\^## ([\d.]+) /", version)
    tree.expect_all(page, "archive", r"nscdd-(\d[\d.]*\d)", version)
    tree.expect_all(page, "library in a package's name", r"libnscdd(?:-mpi)?(\d[\d.]*)", minor)
    tree.expect_all(page, "find_package", r"find_package\(nscdd ([\d.]+)", minor)
    page = "packaging/README.md"
    tree.expect_all(page, "version for Spack", r"nscdd@([\d.]+)", version)
    tree.expect_all(page, "tag of the image", r"nscdd:([\d.]+)", version)
    tree.expect_all(page, "library in a package's name", r"libnscdd(?:-mpi)?(\d[\d.]*)", minor)


def check_day(tree, version):
    headings = re.findall(r"^## (.*)$", tree.text("CHANGELOG.md"), re.MULTILINE)
    tree.expect("CHANGELOG.md", "first heading", "Unreleased", headings[0])
    number, _, day = headings[1].partition(" - ")
    tree.expect("CHANGELOG.md", "second heading", version, number)
    tree.expect_all("CITATION.cff", "date-released", r"^date-released: (.*)$", day)
    tree.expect_all("codemeta.json", "datePublished", r'^  "datePublished": "(.*)"', day)
    signed = re.search(r"^ -- .*  (.*)$", tree.text("debian/changelog"), re.MULTILINE).group(1)
    met = datetime.datetime.strptime(signed, "%a, %d %b %Y %H:%M:%S %z")
    tree.expect("debian/changelog", "day of the first entry", day, met.date().isoformat())


def check_citation(tree):
    name = "CITATION.cff"
    citation = yaml.safe_load(tree.text(name))
    for key in ("cff-version", "message", "title", "authors", "version", "date-released", "license", "abstract"):
        tree.expect(name, f"key {key}", True, bool(citation.get(key)))
    tree.expect(name, "cff-version", "1.2.0", citation["cff-version"])
    known = {"cff-version", "message", "title", "abstract", "type", "version", "date-released", "license", "authors",
             "keywords", "references", "doi", "url", "repository-code", "identifiers", "contact"}
    tree.expect(name, "keys that the format does not have", set(), set(citation) - known)
    for work in citation["references"]:
        for key in ("type", "title", "authors", "journal", "year", "doi"):
            tree.expect(name, f"key {key} of a reference", True, bool(work.get(key)))
    return citation


def check_codemeta(tree, citation, needed):
    name = "codemeta.json"
    meta = json.loads(tree.text(name))
    tree.expect(name, "context", "https://w3id.org/codemeta/3.0", meta["@context"])
    tree.expect(name, "type", "SoftwareSourceCode", meta["@type"])
    tree.expect(name, "terms that CodeMeta does not have", set(), set(meta) - CODEMETA)
    tree.expect(name, "licence", f"https://spdx.org/licenses/{citation['license']}", meta["license"])
    tree.expect(name, "description", citation["abstract"], meta["description"])
    tree.expect(name, "keywords", citation["keywords"], meta["keywords"])
    tree.expect(name, "authors", [one["name"] for one in citation["authors"]], [one["name"] for one in meta["author"]])
    works = [(one["name"], one["identifier"].removeprefix("https://doi.org/")) for one in meta["referencePublication"]]
    tree.expect(name, "publications", [(one["title"], one["doi"]) for one in citation["references"]], works)
    tree.expect(name, "requirements", sorted(NAMES[one][2] for one in needed), sorted(meta["softwareRequirements"]))
    for key in ("readme", "softwareHelp", "buildInstructions"):
        tree.expect(name, f"the file of {key}", True, os.path.exists(tree.path(meta[key])))


def package_groups(tree):
    """The groups of tools/packages.txt: name to packages."""
    groups, current = {}, None
    for line in tree.text("tools/packages.txt").splitlines():
        heading = re.fullmatch(r"\[(.*)\]", line)
        if heading:
            current = groups.setdefault(heading.group(1), set())
        elif line and not line.startswith("#"):
            current.add(line)
    return groups


def stanzas(text):
    """Stanzas of a control file: field to text, on one line."""
    for stanza in re.split(r"\n\n+", text.strip()):
        yield {field: " ".join(value.split())
               for field, value in re.findall(r"^([\w-]+):((?:.*\n?(?:[ \t].*\n?)*))", stanza + "\n", re.MULTILINE)}


def names(field):
    return {re.split(r"[ (]", one.strip())[0] for one in field.split(",") if one.strip()}


def check_debian(tree):
    name, groups = "debian/control", package_groups(tree)
    source, *packages = stanzas(tree.text(name))
    built_with = names(source["Build-Depends"]) - {"debhelper-compat"}
    # g++ is in build-essential, which every build has.
    tree.expect(name, "what tools/packages.txt has to build with, and this has not", set(),
                (groups["build"] | groups["mpi"]) - {"g++"} - built_with)
    listed = groups["build"] | groups["mpi"] | groups["python"] | groups["package"]
    tree.expect(name, "what tools/packages.txt does not have", set(), built_with - listed)
    made = {one["Package"] for one in packages}
    for package in sorted(made):
        tree.expect(name, f"{package} has its list of files", True,
                    any(os.path.exists(tree.path(f"debian/{package}.{kind}")) for kind in ("install", "docs")))
    for file in sorted(os.listdir(tree.path("debian"))):
        if file.endswith(".install"):
            tree.expect(f"debian/{file}", "its package is in debian/control", True, file[:-len(".install")] in made)
    for test in stanzas(tree.text("debian/tests/control")):
        script = f"debian/tests/{test['Tests']}"
        tree.expect(script, "can be run", True, os.access(tree.path(script), os.X_OK))
        tree.expect(script, "depends on a package that is built here", True, bool(names(test["Depends"]) & made))


def check_recipes(tree, needed):
    name = "packaging/spack/package.py"
    calls = [node for node in ast.walk(ast.parse(tree.text(name))) if isinstance(node, ast.Call)]
    depends = {re.split("[@+~ ]", call.args[0].value)[0] for call in calls
               if getattr(call.func, "id", None) == "depends_on"}
    tree.expect(name, "what CMakeLists.txt looks for and this has not", set(),
                {NAMES[one][0] for one in needed} - depends)
    name = "packaging/guix/nscdd.scm"
    inputs = re.findall(r"\((?:native-|propagated-)?inputs \(list ([^)]*)\)", tree.text(name))
    tree.expect(name, "what CMakeLists.txt looks for and this has not", set(),
                {NAMES[one][1] for one in needed} - set(" ".join(inputs).split()))


def check_templates(tree):
    folder = ".github/ISSUE_TEMPLATE"
    templates = [file for file in sorted(os.listdir(tree.path(folder))) if file.endswith(".md")]
    tree.expect(folder, "a template", True, bool(templates))
    for file in templates:
        name = f"{folder}/{file}"
        parts = tree.text(name).split("---\n", 2)
        tree.expect(name, "begins with its name between lines of ---", ("", 3), (parts[0], len(parts)))
        front = yaml.safe_load(parts[1])
        for key in ("name", "about"):
            tree.expect(name, f"key {key}", True, bool(front.get(key)))
        for question in ("nscdd --version", "command"):
            tree.expect(name, f"asks for: {question}", True, question in parts[2])


def main():
    if len(sys.argv) not in (2, 3):
        sys.exit("usage: release.py SOURCE [PROGRAM]")
    tree = Tree(sys.argv[1])
    build = tree.text("CMakeLists.txt")
    version = re.search(r"project\(nscdd VERSION ([\d.]+)", build).group(1)
    needed = re.findall(r"^find_package\((\w+)", build, re.MULTILINE)
    tree.expect("CMakeLists.txt", "what this test knows the names of", set(NAMES), set(needed))
    if len(sys.argv) == 3:
        said = subprocess.run([sys.argv[2], "--version"], capture_output=True, text=True, check=True, timeout=60).stdout
        tree.expect("nscdd --version", "first line", f"nscdd {version}", said.splitlines()[0])
    check_version(tree, version)
    check_day(tree, version)
    check_codemeta(tree, check_citation(tree), [one for one in needed if one in NAMES])
    check_debian(tree)
    check_recipes(tree, [one for one in needed if one in NAMES])
    check_templates(tree)
    if tree.wrong:
        sys.exit("\n".join(tree.wrong))


if __name__ == "__main__":
    main()
