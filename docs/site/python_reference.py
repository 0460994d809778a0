# SPDX-License-Identifier: GPL-3.0-or-later
"""The reference of the Python package from its docstrings, which are plain text: a directive `package`, which has the
names of the package in its content, each with its members."""
import importlib
import inspect
import re

from docutils import nodes
from docutils.statemachine import StringList
from sphinx.util.docutils import SphinxDirective
from sphinx.util.inspect import stringify_signature

import plain_text

SELF = re.compile(r"\(self: [\w.]+(?:, )?")
MODULE = re.compile(r"\bnscdd\._core\.|\bnumpy\.(?=ndarray)|\b_arguments\.|\b_core\.|'(?=_arguments)")


def as_plain_text(app, what, name, thing, options, lines):
    text = "\n".join(lines).strip("\n")
    # The first line of a compiled function is its signature, which autodoc has taken.
    if re.match(rf"{name.rpartition('.')[2]}\(.*\)( -> .*)?(\n|$)", text):
        text = text.partition("\n")[2].strip("\n")
    lines[:] = plain_text.to_rst(text)


def plain_signature(app, what, name, thing, options, signature, result):
    """With the annotations as the source has them. Those of compiled functions are in their docstrings, with `self`,
    and those of a class in the docstring of its constructor."""
    if inspect.isfunction(thing):
        written = inspect.signature(thing)
        kept = [one for one in written.parameters.values() if one.name != "self"]
        signature = stringify_signature(written.replace(parameters=kept), show_return_annotation=False)
        result = result and str(written.return_annotation)
    if what == "class" and signature is None:
        found = re.match(r"__init__(\(.*\)) -> None", thing.__init__.__doc__ or "")
        signature = found and found.group(1)
    if what == "class" and signature == "(*args, **kwargs)":  # of SciPy's base class: users call functions instead
        signature = ""
    return signature and MODULE.sub("", SELF.sub("(", signature)), result and MODULE.sub("", result)


class PackageDirective(SphinxDirective):
    has_content = True

    def run(self):
        package, lines = importlib.import_module("nscdd"), []
        for name in " ".join(self.content).split():
            thing = getattr(package, name)
            kind = "autofunction"
            if isinstance(thing, type):
                kind = "autoexception" if issubclass(thing, Exception) else "autoclass"
            lines += [f".. {kind}:: nscdd.{name}", *(["   :members:"] if kind == "autoclass" else []), ""]
        container = nodes.container()
        self.state.nested_parse(StringList(lines, source=self.env.docname), 0, container)
        return container.children


def setup(app):
    app.add_directive("package", PackageDirective)
    app.connect("autodoc-process-docstring", as_plain_text)
    app.connect("autodoc-process-signature", plain_signature)
    return {"parallel_read_safe": True}
