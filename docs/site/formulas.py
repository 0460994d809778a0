# SPDX-License-Identifier: GPL-3.0-or-later
"""Formulas of the documents, which are plain text so that they can be read anywhere, as the site sets them: X_η with a
subscript, M^-1/2 with a superscript, and indented blocks of formulas in a serif face with columns where they have any.
Beside that, links that are called by the name of a document's file.
"""
import re

from docutils import nodes
from sphinx.transforms.post_transforms import SphinxPostTransform

# One or two letters with an accent, then "_" and what stands below: {E,η}, or letters and figures, with commas between
# Greek ones. What stands above behind "^" is a number, such as -1/2.
SUBSCRIPT = re.compile(r"(?<![^\W\d]|[\\.])(?P<base>[d∂√²]?[A-Za-z\u0370-\u03ff][\u0300-\u036f]?)"
                       r"_(?:\{(?P<braced>[^{}]+)\}|(?P<plain>[A-Za-z0-9\u0370-\u03ff]+(?:,[\u0370-\u03ff])*|∞))"
                       r"|\^(?P<power>\{[^{}]+\}|-?\d+(?:/\d+)?)")
BLOCKS = ("docs/theory", "docs/algorithms", "docs/tutorials/law")
WIDE = re.compile(r" {2,}")


def pieces(text):
    """Nodes of a text with its sub- and superscripts, or None where it has none."""
    result, end = [], 0
    for found in SUBSCRIPT.finditer(text):
        if found["power"]:
            result += [nodes.Text(text[end:found.start()]), nodes.superscript(text=found["power"].strip("{}"))]
        else:
            result += [nodes.Text(text[end:found.start()] + found["base"]),
                       nodes.subscript(text=found["braced"] or found["plain"])]
        end = found.end()
    return result and [*result, nodes.Text(text[end:])]


def is_formula(block):
    """Indented blocks have no language. Matrices drawn with brackets keep their blanks."""
    if block.get("language", "none") not in ("none", "default"):
        return False
    return not re.search(r"^\s*\[|[│─└┘┌┐]", block.astext(), re.M)


def line_of(text):
    """A line with its gaps as wide blanks."""
    line = nodes.line()
    for k, part in enumerate(WIDE.split(text.strip())):
        if k > 0:
            line += nodes.Text("\u2003\u2003")
        line += pieces(part) or [nodes.Text(part)]
    return line


def table_of(rows):
    """Lines of equal columns."""
    table, group = nodes.table(classes=["formula"]), nodes.tgroup(cols=len(rows[0]))
    group += [nodes.colspec(colwidth=1) for _ in rows[0]]
    body = nodes.tbody()
    for row in rows:
        entries = [nodes.entry("", nodes.paragraph("", "", *(pieces(cell) or [nodes.Text(cell)]))) for cell in row]
        body += nodes.row("", *entries)
    group += body
    table += group
    return table


def formula(block):
    rows = [WIDE.split(line.strip()) for line in block.astext().splitlines() if line.strip()]
    columns = {len(row) for row in rows}
    if len(rows) > 1 and len(columns) <= 2 and min(columns) > 2:
        width = min(columns)
        return table_of([row[:width - 1] + ["\u2003\u2003".join(row[width - 1:])] for row in rows])
    lines = nodes.line_block(classes=["formula"])
    lines += [line_of(line) for line in block.astext().splitlines()]
    return lines


class SetFormulas(SphinxPostTransform):
    default_priority = 900

    def run(self, **_):
        docname = self.env.docname
        if not docname.startswith(("docs/", "studies/", "src/", "benchmarks/")) or docname == "docs/site/cpp":
            return
        if docname in BLOCKS:
            for block in list(self.document.findall(nodes.literal_block)):
                if is_formula(block):
                    block.replace_self(formula(block))
        for text in list(self.document.findall(nodes.Text)):
            if any(isinstance(parent, (nodes.literal, nodes.literal_block, nodes.raw, nodes.subscript))
                   for parent in ancestors(text)):
                continue
            found = pieces(text.astext())
            if found:
                text.parent.replace(text, found)


class NameDocuments(SphinxPostTransform):
    """Links that documents call by a file name, which is right in a tree, have its stem on the site."""

    default_priority = 890

    def run(self, **_):
        for reference in self.document.findall(nodes.reference):
            named = re.fullmatch(r"(?:[\w.-]+/)*([\w-]+)\.md", reference.astext())
            text = next(reference.findall(nodes.Text), None)
            if named and text is not None:
                text.parent.replace(text, nodes.Text(named.group(1)))


def ancestors(node):
    while node.parent is not None:
        node = node.parent
        yield node


def setup(app):
    app.add_post_transform(SetFormulas)
    app.add_post_transform(NameDocuments)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
