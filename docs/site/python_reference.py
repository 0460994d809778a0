# SPDX-License-Identifier: GPL-3.0-or-later
"""The reference of the Python package from its docstrings, which are plain text: a directive `package NAME...` with
these names of the package, each with its members."""
import re

from docutils.statemachine import StringList
from sphinx.util.docutils import SphinxDirective

import plain_text

SELF = re.compile(r"\(self: [\w.]+(?:, )?")


def as_plain_text(app, what, name, thing, options, lines):
    # The first line of a compiled function is its signature, which autodoc has taken.
    text = "\n".join(lines).strip("\n")
    if what in ("method", "function") and re.match(rf"{name.rpartition('.')[2]}\(.*\)( -> .*)?(\n|$)", text):
        text = text.partition("\n")[2].strip("\n")
    lines[:] = plain_text.to_rst(text)


def without_self(app, what, name, thing, options, signature, result):
    return signature and SELF.sub("(", signature), result


class PackageDirective(SphinxDirective):
    has_content = True

    def run(self):
        package = __import__(self.config.python_package)
        lines = []
        for name in " ".join(self.content).split():
            kind = "autoclass" if isinstance(getattr(package, name), type) else "autofunction"
            if isinstance(getattr(package, name), type) and issubclass(getattr(package, name), Exception):
                kind = "autoexception"
            lines += [f".. {kind}:: {package.__name__}.{name}", *(["   :members:"] if kind == "autoclass" else []), ""]
        return self.parse(lines)

    def parse(self, lines):
        from docutils import nodes
        container = nodes.container()
        self.state.nested_parse(StringList(lines, source=self.env.docname), 0, container)
        return container.children


def setup(app):
    app.add_config_value("python_package", "nscdd", "env")
    app.add_directive("package", PackageDirective)
    app.connect("autodoc-process-docstring", as_plain_text)
    app.connect("autodoc-process-signature", without_self)
    return {"parallel_read_safe": True}
