"""Settings of Sphinx: docs/ becomes the site that `make docs` writes. No network, no web fonts."""

from __future__ import annotations

import sys
from importlib.metadata import distribution
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))  # the extensions beside this file

project = "GHC control stack"
author = "the authors"
html_title = project
html_show_copyright = False

extensions = [
    "myst_nb",
    "sphinx.ext.autodoc",
    "sphinx.ext.napoleon",
    "sphinx.ext.mathjax",
    "class_fields",
    "docstrings",
    "navigation",
    "repository_links",
]
exclude_patterns = ["site", "study", "kinematics", "comparison", "**.ipynb_checkpoints"]

# Markdown as the repository's web view shows it: anchors of headings, formulas between dollars.
myst_enable_extensions = ["dollarmath", "amsmath"]
myst_dmath_double_inline = False
myst_heading_anchors = 4
myst_url_schemes = {"http": None, "https": None, "repository": None}

# Notebooks are run, and an error in one is an error of the build.
nb_execution_mode = "force"
nb_execution_raise_on_error = True
nb_execution_timeout = 180
nb_merge_streams = True

# One script from a package; formulas are drawn as SVG, which needs no fonts.
_MATHJAX = "sphinx-mathjax-offline/static/mathjax/tex-svg.js"
mathjax_path = "tex-svg.js"

html_theme = "furo"
html_static_path = [
    str(distribution("sphinx-mathjax-offline").locate_file(_MATHJAX)),
    "site.css",
]
html_css_files = ["site.css"]
html_copy_source = False
html_show_sphinx = False
html_theme_options = {"top_of_page_buttons": []}
highlight_language = "text"
pygments_style = "friendly"

autodoc_typehints = "signature"
autodoc_member_order = "bysource"
autodoc_default_options = {"members": True}
autodoc_type_aliases = {"Array": "Array", "ArrayLike": "ArrayLike"}
toc_object_entries_show_parents = "hide"
python_use_unqualified_type_names = True
napoleon_numpy_docstring = False
napoleon_use_ivar = True
default_role = "code"
add_module_names = False
