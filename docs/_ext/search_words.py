"""What the search of the site reads: prose and code that a reader writes, without the output of cells."""

from __future__ import annotations

from docutils import nodes
from sphinx.application import Sphinx


def _leave_out_output(_app: Sphinx, doctree: nodes.document) -> None:
    for container in doctree.findall(nodes.container):
        if "cell_output" in container["classes"]:
            container["classes"].append("no-search")


def setup(app: Sphinx) -> dict[str, bool]:
    app.connect("doctree-read", _leave_out_output)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
