"""How Sphinx builds the site; pages below ``made/`` are written anew from the code each time."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from sphinx.application import Sphinx

HERE = Path(__file__).parent
sys.path.insert(0, str(HERE.parent))

from docs.making import write_pages  # noqa: E402
from docs.making.docstrings import prepare  # noqa: E402

project = "PolyFold"
author = "the PolyFold contributors"
extensions = ["myst_parser", "sphinx.ext.autodoc", "sphinx.ext.napoleon"]
source_suffix = {".md": "markdown"}
exclude_patterns = ["making"]
html_theme = "furo"
html_title = "PolyFold"
html_show_sourcelink = False
html_copy_source = False
html_static_path = ["style"]
html_css_files = ["pictures.css"]

myst_heading_anchors = 3
myst_enable_extensions = ["attrs_block"]

autodoc_member_order = "bysource"
autodoc_typehints_format = "short"
autodoc_class_signature = "separated"
autodoc_default_options = {"members": True}
napoleon_google_docstring = True
napoleon_numpy_docstring = False
napoleon_use_ivar = True
napoleon_attr_annotations = False
napoleon_use_rtype = False
python_use_unqualified_type_names = True
toc_object_entries = False

write_pages(HERE / "made")


def setup(app: Sphinx) -> None:
    """Have docstrings prepared for napoleon, which knows one attribute a line."""
    app.connect("autodoc-process-docstring", prepare, priority=400)
