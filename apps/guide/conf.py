"""Sphinx settings of the guide; `make_guide.py` runs the examples first and calls Sphinx with -W."""

project = "accdec"
author = "The accdec authors"
extensions = ["myst_parser"]
myst_enable_extensions = ["dollarmath"]
myst_heading_anchors = 3
html_theme = "furo"
html_title = "accdec"
html_copy_source = False
html_show_sphinx = False
