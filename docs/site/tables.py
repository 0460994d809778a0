# SPDX-License-Identifier: GPL-3.0-or-later
"""A directive `tables`, which lists the tables of every study with links to the files."""
import glob
import os

from docutils import nodes
from docutils.statemachine import StringList
from sphinx.util.docutils import SphinxDirective


class TablesDirective(SphinxDirective):
    def run(self):
        lines = []
        for study in sorted(glob.glob(os.path.join(self.env.srcdir, "studies", "*", ""))):
            name = os.path.basename(os.path.dirname(study))
            files = [os.path.basename(path) for path in sorted(glob.glob(study + "*.csv"))]
            if files:
                lines += [f":doc:`{name} </studies/{name}/README>`",
                          "   " + " · ".join(f":download:`{file} </studies/{name}/{file}>`" for file in files), ""]
        container = nodes.container()
        self.state.nested_parse(StringList(lines, source=self.env.docname), 0, container)
        return container.children


def setup(app):
    app.add_directive("tables", TablesDirective)
    return {"parallel_read_safe": True}
