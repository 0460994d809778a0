# SPDX-License-Identifier: GPL-3.0-or-later
"""The site, from the Markdown files where they lie: tools/site starts Sphinx with this."""
import os
import re
import sys

FOLDER = os.path.dirname(os.path.abspath(__file__))
ROOT = os.path.dirname(os.path.dirname(FOLDER))
sys.path[:0] = [FOLDER]
from plain_text import anchor_of  # noqa: E402, it lies beside this file

with open(os.path.join(ROOT, "CMakeLists.txt"), encoding="utf-8") as file:
    release = version = re.search(r"project\(nscdd VERSION ([\d.]+)", file.read()).group(1)

project = "nscdd"
root_doc = "docs/site/index"
include_patterns = ["docs/**.md", "docs/site/*.rst", "studies/*/README.md", "benchmarks/README.md",
                    "packaging/README.md", "src/linalg/multifrontal/README.md", "CONTRIBUTING.md", "CHANGELOG.md"]
exclude_patterns = ["build", "results", ".git"]
extensions = ["myst_parser", "sphinx.ext.autodoc", "sphinx_copybutton", "cpp_reference", "python_reference", "tables",
              "formulas"]

myst_heading_anchors = 4
myst_heading_slug_func = anchor_of
highlight_language = "none"
pygments_style = "friendly"
doxygen_xml = os.environ["NSCDD_DOXYGEN_XML"]
include_folder = os.path.join(ROOT, "include")
autodoc_member_order = "bysource"
autodoc_typehints = "signature"

html_theme = "furo"
html_title = f"nscdd {release}"
html_static_path = ["static"]
html_css_files = ["site.css"]
html_copy_source = False
html_show_sphinx = False
html_show_copyright = False
html_last_updated_fmt = None
FONTS = {
    "font-stack": "system-ui, -apple-system, 'Segoe UI', Roboto, 'Noto Sans', 'DejaVu Sans', Arial, sans-serif",
    "font-stack--monospace": "ui-monospace, 'DejaVu Sans Mono', Menlo, Consolas, monospace",
}
LIGHT = {
    **FONTS, "color-brand-primary": "#1f5f99", "color-brand-content": "#1f5f99", "color-background-primary": "#ffffff",
    "color-foreground-primary": "#1a1a1a",
}
html_theme_options = {"light_css_variables": LIGHT, "navigation_with_keys": True}
copybutton_prompt_text = "$ "
copybutton_line_continuation_character = "\\"

html_extra_path = [os.environ["NSCDD_REPORT"]]  # the interactive page of one packing
