#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Builds the site and checks its pages.

usage: site.py SOURCE FOLDER

SOURCE is the root of the tree, FOLDER where the site is put. tools/site itself fails at warnings of Sphinx. Checked are
  - pages need nothing from elsewhere: no script, style, font, picture or frame has an address of another place;
  - links within the site lead to a file that is there, and to a place in it that is there;
  - every Markdown file is a page, or left out by name; every figure of docs/figures is shown;
  - every public header is in the C++ reference with what it declares, and every name of the Python package in its own.
"""
import html.parser
import os
import re
import subprocess
import sys
import time
import urllib.parse
from pathlib import Path

# The start page of forges, for which the site has one of its own, and what forges put into a new issue.
LEFT_OUT = {"README.md"}
FORGES = ".github/"
FETCHED = {"script": "src", "link": "href", "img": "src", "iframe": "src", "source": "src", "video": "src"}
STYLE_ADDRESS = re.compile(r"url\(\s*['\"]?([^'\")]+)|@import\s+['\"]([^'\"]+)")


class Page(html.parser.HTMLParser):
    """What a page fetches, where it links to, the places in it, and its text."""

    def __init__(self, path):
        super().__init__()
        self.fetched, self.links, self.places, self.words, self.style = [], [], {""}, [], False
        self.feed(Path(path).read_text(encoding="utf-8"))

    def handle_starttag(self, tag, attributes):
        given = dict(attributes)
        self.places.update(given[name] for name in ("id", "name") if given.get(name))
        if tag in FETCHED and given.get(FETCHED[tag]):
            only_named = given.get("rel", "") in ("next", "prev", "index", "search")
            (self.links if only_named else self.fetched).append(given[FETCHED[tag]])
        if tag == "a" and given.get("href"):
            self.links.append(given["href"])
        self.style = tag == "style"

    def handle_data(self, data):
        self.words.append(data)
        if self.style:
            self.fetched += addresses(data)


def addresses(style):
    return [a or b for a, b in STYLE_ADDRESS.findall(style) if not (a or b).startswith(("data:", "#"))]


def is_elsewhere(address):
    return bool(re.match(r"(?:[a-z][a-z+.-]*:)?//", address)) and not address.startswith("data:")


def files(folder, ending):
    for place, _, names in os.walk(folder):
        for name in sorted(names):
            if name.endswith(ending):
                yield os.path.relpath(os.path.join(place, name), folder)


def target(page, address):
    """(file, place in it) of an address within the site."""
    path, _, place = address.partition("#")
    path = urllib.parse.unquote(path.partition("?")[0])
    where = os.path.normpath(os.path.join(os.path.dirname(page), path)) if path else page
    return where, urllib.parse.unquote(place)


def wrong_addresses(folder, pages):
    for name, page in pages.items():
        for address in page.fetched:
            if is_elsewhere(address):
                yield f"{name}: fetches {address}"
        for address in page.links + page.fetched:
            if re.match(r"[a-z][a-z+.-]*:", address) or is_elsewhere(address):
                continue
            where, place = target(name, address)
            if not os.path.isfile(os.path.join(folder, where)):
                yield f"{name}: link to {address}: no such file"
            elif where in pages and place not in pages[where].places:
                yield f"{name}: link to {address}: no such place"
    fetched = {target(name, address)[0] for name, page in pages.items() for address in page.fetched}
    for name in sorted(one for one in fetched if one.endswith(".js") and os.path.isfile(os.path.join(folder, one))):
        if re.search(r"^(import|export)\b", Path(folder, name).read_text(encoding="utf-8"), re.M):
            yield f"{name}: a module, which pages in a folder cannot load"
    for name in files(folder, ".css"):
        for address in addresses(Path(folder, name).read_text(encoding="utf-8")):
            if is_elsewhere(address) or not os.path.isfile(os.path.join(folder, target(name, address)[0])):
                yield f"{name}: fetches {address}"


def without_page(source, folder, pages):
    tracked = subprocess.run(["git", "ls-files", "*.md", "docs/figures"], cwd=source, capture_output=True, text=True,
                             check=False).stdout.split()
    documents = tracked or list(files(source, ".md"))
    shown = {urllib.parse.unquote(os.path.basename(address)) for page in pages.values() for address in page.fetched}
    for name in documents:
        if name.startswith("docs/figures/"):
            if os.path.basename(name) not in shown:
                yield f"{name}: on no page"
        elif name.endswith(".md") and name not in LEFT_OUT and not name.startswith(FORGES):
            if name[:-3] + ".html" not in pages:
                yield f"{name}: has no page"


def declared(header):
    """Names of the structs, classes and enumerations of a header, and of its functions at the left margin."""
    names = set(re.findall(r"^(?:struct|class|enum class) (\w+)[^;]*$", header, re.M))
    return names | {name for name in re.findall(r"^[A-Za-z][\w:<>,& ]* (\w+)\([^;{]*[;{]", header, re.M)} - {"names_of"}


def not_in_reference(source, pages):
    text = "".join(pages["docs/site/cpp.html"].words)
    for name in files(os.path.join(source, "include"), ".hpp"):
        if name == "nscdd/nscdd.hpp":
            continue
        if f"<{name}>" not in text:
            yield f"{name}: not in the C++ reference"
        for one in sorted(declared(Path(source, "include", name).read_text(encoding="utf-8"))):
            if not re.search(rf"\b{one}\b", text):
                yield f"{name}: {one} is not in the C++ reference"
    with open(os.path.join(source, "python/nscdd/__init__.py"), encoding="utf-8") as stream:
        names = re.findall(r'"(\w+)"', stream.read().partition("__all__")[2])
    for name in names:
        if not name.startswith("__") and f"nscdd.{name}" not in pages["docs/site/python.html"].places:
            yield f"python/nscdd: {name} is not in the Python reference"


def main():
    if len(sys.argv) != 3:
        sys.exit("usage: site.py SOURCE FOLDER")
    source, folder = sys.argv[1:]
    begin = time.monotonic()
    built = subprocess.run([os.path.join(source, "tools/site"), folder], capture_output=True, text=True, check=False)
    if built.returncode != 0:
        sys.exit(f"tools/site failed:\n{built.stdout}{built.stderr}")
    pages = {name: Page(os.path.join(folder, name)) for name in files(folder, ".html")}
    print(f"{len(pages)} pages, built in {time.monotonic() - begin:.0f} s")
    wrong = [*wrong_addresses(folder, pages), *without_page(source, folder, pages), *not_in_reference(source, pages)]
    print("\n".join(wrong))
    if wrong:
        sys.exit(f"{len(wrong)} places of the site are not right")


if __name__ == "__main__":
    main()
