# SPDX-License-Identifier: GPL-3.0-or-later
"""Comments of the headers and docstrings of the Python package, which are plain text, as reStructuredText.

usage: plain_text.py HEADER: prints a header for Doxygen, which then leaves the shape of comments alone.

What plain text says by its shape is kept: indented lines stand as they are, "- " begins an item, and a name with three
or more blanks behind it begins the description of a parameter.
"""
import re
import sys

ITEM = re.compile(r"(- |\d+\. )")
PARAMETER = re.compile(r"(\w+(?:, \w+)*) {3,}(\S.*)")


def escaped(text):
    """Text whose marks mean nothing, but for code in `single` or ``double`` backquotes."""
    parts = re.split(r"(`[^`]+`)", text.replace("``", "`"))
    return "".join(f"``{part[1:-1]}``" if part.startswith("`") and len(part) > 2 else
                   re.sub(r"([\\*_|`])", r"\\\1", part) for part in parts)


def kind_of(line):
    if not line.strip():
        return "blank"
    if ITEM.match(line):
        return "item"
    if PARAMETER.match(line):
        return "parameter"
    return "shape" if line.startswith("  ") else "text"


def groups(lines):
    """(kind, lines) of paragraphs, items, parameters and indented lines. Indented lines behind an item or a parameter
    belong to it."""
    found = []
    for line in lines:
        kind = kind_of(line)
        before = found[-1][0] if found else "blank"
        goes_on = kind == before and kind in ("text", "shape")
        if goes_on or (kind == "shape" and before in ("item", "parameter")):
            found[-1][1].append(line)
        else:
            found.append((kind, [line]))
    return [group for group in found if group[0] != "blank"]


def to_rst(text):
    """Lines of reStructuredText for plain text, whose indentation is that of its first line."""
    result = []
    for kind, lines in groups(text.splitlines()):
        joined = " ".join(line.strip() for line in lines)
        if kind == "text":
            result += [escaped(joined), ""]
        elif kind == "shape":
            result += ["::", "", *("   " + line for line in lines), ""]
        elif kind == "item":
            mark = ITEM.match(joined).group(1)
            result += [mark + escaped(joined[len(mark):]), ""]
        else:
            name, description = PARAMETER.match(joined).groups()
            result += [f"``{name}``", "   " + escaped(description), ""]
    return result


def anchor_of(heading):
    """The anchor of a heading of a document, as forges make it."""
    return re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-")


def verbatim(header):
    """A header whose comments of "///" lines Doxygen passes on as they are."""
    result, inside = [], False
    for line in header.splitlines():
        comment = re.match(r"\s*///(?!<)", line)
        if inside and not comment:
            result[-1] += " @endverbatim"
        result.append(line if not comment or inside else line.replace("///", "/// @verbatim ", 1))
        inside = bool(comment)
    return "\n".join(result) + "\n"


if __name__ == "__main__":
    with open(sys.argv[1], encoding="utf-8") as stream:
        print(verbatim(stream.read()), end="")
