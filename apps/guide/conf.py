"""Sphinx settings of the guide; `make_guide.py` runs the examples first and calls Sphinx with -W."""
import os

from docutils import nodes
from docutils.utils.math import latex2mathml

project = "accdec"
author = "The accdec authors"
extensions = ["myst_parser", "sphinx.ext.autodoc", "sphinx.ext.napoleon", "breathe"]
myst_enable_extensions = ["deflist", "dollarmath"]
myst_heading_anchors = 3
html_theme = "furo"
html_title = "accdec"
html_copy_source = False
html_show_sphinx = html_show_copyright = False
html_static_path = ["static"]
html_css_files = ["wide.css"]
autodoc_member_order = "groupwise"
autodoc_typehints = "none"  # signatures and docstrings have them
napoleon_google_docstring = False
napoleon_use_rtype = False
breathe_projects = {"accdec": os.environ["ACCDEC_DOXYGEN_XML"]}
breathe_default_project = "accdec"
html_math_renderer = "mathml"


def setup(app):
    """Formulas as MathML, which browsers draw themselves: Sphinx' own way fetches a script from the network."""
    def inline(writer, node):
        writer.body.append(latex2mathml.tex2mathml(node.astext(), inline=True))
        raise nodes.SkipNode

    def block(writer, node):
        writer.body.append('<div class="math">' + latex2mathml.tex2mathml(node.astext(), inline=False) + "</div>")
        raise nodes.SkipNode

    app.add_html_math_renderer("mathml", (inline, None), (block, None))
