#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Checks that the Markdown files of the repository are true where a program can tell.

usage: check.py SOURCE

SOURCE is the root of the tree. Checked are
  - lines: at most 120 characters, those of tables too, apart from pictures and links that stand alone;
  - links: the file is there, and the heading that an anchor names;
  - paths in code spans, such as `plots/size.py`: the file is there (NAME, STUDY and the like stand for any name);
  - names in the tables of docs/notation.md, such as `Contraction::system`: the sources have them;
  - comments in the sources that cite a document, or a section of docs/theory.md by its number: it is there.
"""
import os
import re
import sys
from pathlib import Path

LONGEST = 120
SOURCES = ("include", "src", "tests", "plots", "benchmarks", "studies", "cases", "tools", "cmake", "python",
           "packaging", "debian")
ROOTS = SOURCES + ("docs", ".ci")


def texts(root, folder, endings):
    """(path, text) of the files below a folder."""
    for place, folders, names in os.walk(os.path.join(root, folder)):
        folders[:] = sorted(f for f in folders if not f.startswith("build"))
        for name in sorted(names):
            if name.endswith(endings):
                path = os.path.join(place, name)
                yield os.path.relpath(path, root), Path(path).read_text(encoding="utf-8")


def documents(root):
    """The Markdown files: at the top, in docs/ and anywhere among the sources."""
    found = {}
    for name in sorted(os.listdir(root)):
        if name.endswith(".md"):
            found[name] = Path(root, name).read_text(encoding="utf-8")
    for folder in ("docs",) + SOURCES:
        found.update(texts(root, folder, ".md"))
    return found


def prose(text):
    """(line number, line) outside of fenced code."""
    fenced = False
    for number, line in enumerate(text.splitlines(), 1):
        if line.lstrip().startswith("```"):
            fenced = not fenced
        elif not fenced:
            yield number, line


def anchors(text):
    """Anchors of the headings, as GitHub makes them."""
    found = set()
    for _, line in prose(text):
        heading = re.match(r"#+ +(.*)", line)
        if heading:
            slug = re.sub(r"[^\w\- ]", "", heading.group(1).lower()).replace(" ", "-")
            found.add(slug)
    return found


def long_lines(name, text):
    for number, line in enumerate(text.splitlines(), 1):
        alone = re.match(r"\s*(!|<img|<a )", line) or re.fullmatch(r"\s*([-*] )?\[[^]]*\]\([^)]*\)[.,;]?", line)
        if len(line) > LONGEST and not alone:
            yield f"{name}:{number}: {len(line)} characters, expected at most {LONGEST}"


def broken_links(root, name, text, all_documents):
    for number, line in prose(text):
        targets = re.findall(r"\]\(([^)\s]+)\)", line) + re.findall(r'(?:src|href)="([^"]+)"', line)
        for target in targets:
            if re.match(r"[a-z]+:", target):
                continue
            path, _, anchor = target.partition("#")
            place = os.path.normpath(os.path.join(os.path.dirname(name), path)) if path else name
            if not os.path.exists(os.path.join(root, place)):
                yield f"{name}:{number}: link to {target}: no such file"
            elif anchor and place in all_documents and anchor not in anchors(all_documents[place]):
                yield f"{name}:{number}: link to {target}: no such heading"


def absent_paths(root, name, text):
    if name == "CHANGELOG.md":  # tells of files that were
        return
    for number, line in prose(text):
        for span in re.findall(r"`([^`]+)`", line):
            path = span.split(" ")[0].rstrip("/")
            if not re.fullmatch(r"[\w./-]+", path) or path.split("/")[0] not in ROOTS or "/" not in path:
                continue
            if re.search(r"[A-Z]{3}", os.path.basename(path).split(".")[0]):  # NAME.hpp, verb_NAME.cpp
                path = os.path.dirname(path)
            if not os.path.exists(os.path.join(root, path)):
                yield f"{name}:{number}: `{span}`: no such file"


def unknown_names(text, code):
    for number, line in prose(text):
        if not line.startswith("|"):
            continue
        for span in re.findall(r"`([\w:]+)`", line):
            for part in span.split("::"):
                if not re.search(rf"\b{part}\b", code):
                    yield f"docs/notation.md:{number}: `{span}`: the sources have no {part}"


def false_citations(root, name, text, theory):
    for number, line in enumerate(text.splitlines(), 1):
        for path in re.findall(r"\bdocs/[\w-]+\.md", line):
            if not os.path.exists(os.path.join(root, path)):
                yield f"{name}:{number}: {path}: no such document"
        for section in re.findall(r"theory(?:\.md)?,? section (\d+)", line):
            if not re.search(rf"^## {section}\. ", theory, re.MULTILINE):
                yield f"{name}:{number}: docs/theory.md has no section {section}"


def main():
    if len(sys.argv) != 2:
        sys.exit("usage: check.py SOURCE")
    root = sys.argv[1]
    found = documents(root)
    code, wrong = "", []
    for folder in SOURCES:
        for name, text in texts(root, folder, (".hpp", ".cpp", ".py", ".toml", ".md")):
            wrong += false_citations(root, name, text, found["docs/theory.md"])
            if folder in ("include", "src"):
                code += text
    for name, text in found.items():
        wrong += long_lines(name, text)
        wrong += broken_links(root, name, text, found)
        wrong += absent_paths(root, name, text)
        wrong += false_citations(root, name, text, found["docs/theory.md"])
    wrong += unknown_names(found["docs/notation.md"], code)
    print("\n".join(wrong))
    if wrong:
        sys.exit(f"{len(wrong)} places are not true")


if __name__ == "__main__":
    main()
