"""Pages with cells as notebooks to download, without output, and a link to the notebook on top of the page."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import nbformat
from myst_nb.core.read import read_myst_markdown_notebook
from sphinx.application import Sphinx

FOLDER = "_downloads"


def notebook_of(text: str) -> nbformat.NotebookNode:
    """A page of MyST Markdown with cells as a notebook."""
    notebook = read_myst_markdown_notebook(text)
    for number, cell in enumerate(notebook.cells):
        cell.id = f"cell-{number}"
    return notebook


def _add_link(app: Sphinx, pagename: str, _template: str, context: dict[str, Any], _doctree: Any) -> None:
    source = Path(app.srcdir) / f"{pagename}.md"
    if not source.is_file() or "```{code-cell}" not in (text := source.read_text("utf-8")):
        return
    target = Path(app.outdir) / FOLDER / f"{pagename.replace('/', '-')}.ipynb"
    target.parent.mkdir(exist_ok=True)
    nbformat.write(notebook_of(text), target)
    url = context["pathto"](f"{FOLDER}/{target.name}", 1)
    context["body"] = f'<p class="notebook"><a href="{url}" download>Download as a notebook</a></p>\n{context["body"]}'


def setup(app: Sphinx) -> dict[str, bool]:
    app.connect("html-page-context", _add_link)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
