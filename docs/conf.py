"""Builds the documentation: ``sphinx-build -W docs build/docs``."""

from __future__ import annotations

import sys
from pathlib import Path

import ospace

sys.path.insert(0, str(Path(__file__).parent))
import reference

reference.write(Path(__file__).with_name("api"))

project = "ospace"
author = "The ospace developers"
copyright = f"2026, {author}"
release = version = ospace.__version__

extensions = [
    "myst_nb",  # pages in Markdown; tutorials are notebooks in Markdown, run at every build
    "sphinx.ext.autodoc",
    "sphinx.ext.autosummary",
    "sphinx.ext.napoleon",
    "sphinx.ext.mathjax",
    "sphinx.ext.viewcode",
    "sphinx_gallery.gen_gallery",
    "sphinx_copybutton",
]
exclude_patterns = ["build", "gallery/*.ipynb", "gallery/*.py", "gallery/*.zip"]
default_role = "py:obj"  # `name` in a docstring
suppress_warnings = ["config.cache", "ref.python"]  # functions in settings; names that two modules share

myst_enable_extensions = ["colon_fence", "deflist", "dollarmath"]
myst_heading_anchors = 3
nb_execution_mode = "force"
nb_execution_raise_on_error = True
nb_execution_timeout = 300

autosummary_generate = False  # reference.py writes the pages
autodoc_typehints = "none"  # the sections of the docstrings name types, shapes and units
autodoc_member_order = "bysource"
napoleon_google_docstring = False
napoleon_use_rtype = False
napoleon_use_ivar = True

sphinx_gallery_conf = {
    "examples_dirs": "../examples",
    "gallery_dirs": "gallery",
    "filename_pattern": r"\.py$",
    "abort_on_example_error": True,
    "download_all_examples": False,
    "show_memory": False,
    "show_signature": False,
    "min_reported_time": 10**6,
    "within_subsection_order": "FileNameSortKey",
}

html_theme = "furo"
html_title = f"ospace {release}"
html_static_path: list[str] = []
copybutton_prompt_text = "$ "
