"""The site: `sphinx-build -W -j auto docs docs/_build/html`, with the extra `docs` installed and nothing else."""

from __future__ import annotations

import os
import sys
from pathlib import Path

import eigencontact

HERE = Path(__file__).parent
sys.path.insert(0, str(HERE / "_ext"))

from content import code_hash  # noqa: E402 - lies in _ext

# Cells call the program as a reader does: by its name, on a terminal that is no terminal.
os.environ["PATH"] = os.pathsep.join([str(Path(sys.executable).parent), os.environ.get("PATH", "")])
os.environ |= {"COLUMNS": "92", "TERM": "dumb", "NO_COLOR": "1", "PYDEVD_DISABLE_FILE_VALIDATION": "1"}
os.environ.setdefault("OMP_NUM_THREADS", "2")

project = "eigencontact"
author = "The eigencontact developers"
copyright = "The eigencontact developers, BSD-3-Clause"  # noqa: A001 - Sphinx names it so
release = version = eigencontact.__version__

extensions = [
    "myst_nb",
    "sphinx.ext.autodoc",
    "sphinx.ext.autosummary",
    "numpydoc",
    "sphinx_design",
    "sphinx_copybutton",
    "mathml",
    "generated",
    "docstrings",
    "search_words",
    "notebooks",
]
exclude_patterns = ["_build", "_cache", "_ext"]
templates_path = ["_templates"]

myst_enable_extensions = ["dollarmath", "amsmath", "deflist", "colon_fence", "attrs_inline", "substitution"]
myst_heading_anchors = 4
# Pages are executed again as soon as the code has changed: no figure is older than its code.
nb_execution_mode = "cache"
nb_execution_cache_path = str(HERE / "_cache" / f"cells-{code_hash()[:16]}")
nb_execution_in_temp = True
nb_execution_timeout = 240
nb_execution_raise_on_error = True
nb_merge_streams = True
nb_render_image_options = {"width": "100%"}

autodoc_typehints = "none"
autodoc_member_order = "bysource"
autosummary_generate = True
autosummary_ignore_module_all = False
numpydoc_show_class_members = False
default_role = "code"
suppress_warnings = ["mystnb.unknown_mime_type"]

WITH_SECTIONS = "start", "tutorials", "gallery", "scenes", "reference", "help", "plugins", "theory", "api", "about"
html_theme = "pydata_sphinx_theme"
html_title = "eigencontact"
html_favicon = "_static/logo.svg"
html_static_path = ["_static"]
html_css_files = ["eigencontact.css"]
html_show_sourcelink = False
html_search_scorer = str(HERE / "_ext" / "scorer.js")
html_theme_options = {
    "logo": {"image_light": "_static/logo.svg", "image_dark": "_static/logo.svg", "text": "eigencontact"},
    "show_prev_next": True,
    "navigation_with_keys": False,
    "header_links_before_dropdown": 7,
    "show_toc_level": 2,
    "navbar_align": "left",
    "navbar_end": ["theme-switcher"],
    # The first page and pages of measurements give the width of the list of sections to their tables.
    "secondary_sidebar_items": {f"{folder}/**": ["page-toc"] for folder in WITH_SECTIONS},
    "footer_start": ["copyright"],
    "footer_end": ["sphinx-version"],
    "pygments_light_style": "a11y-high-contrast-light",
    "pygments_dark_style": "a11y-high-contrast-dark",
}
