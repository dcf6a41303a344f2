"""What a notebook shows: small tables with everything escaped; and the uses of the tutorial, each of a few lines."""

import re
from html.parser import HTMLParser
from pathlib import Path

import eigencontact as ec
from eigencontact.core.html_table import html_table

PAGE = Path(__file__).parents[2] / "docs" / "tutorials" / "library-in-a-notebook.md"
HERTZ = {
    "title": "<script>alert('a & b')</script>",
    "body1": {"young-modulus": 210e9, "poisson-ratio": 0.3},
    "geometry": {"type": "sphere", "radius": 105e-6},
    "grid": {"cells": 24, "size": 16e-6},
    "steps": {"normal-load": 0.65},
}


class Text(HTMLParser):
    def __init__(self, html):
        super().__init__()
        self.open, self.tags, self.text = [], [], ""
        self.feed(html)
        assert self.open == []

    def handle_starttag(self, tag, _attrs):
        self.open.append(tag)
        self.tags.append(tag)

    def handle_endtag(self, tag):
        assert self.open.pop() == tag

    def handle_data(self, data):
        self.text += data


def test_runs_and_plans():
    planned = ec.plan(HERTZ)
    result = ec.run(planned)
    for html, words in ((planned._repr_html_(), "24 x 24"), (result._repr_html_(), "650 mN")):
        shown = Text(html)
        assert set(shown.tags) == {"div", "strong", "table", "tr", "th", "td"}
        assert "<script>alert('a & b')</script>" in shown.text
        assert words in shown.text
    peak = f"{result.summary['max_pressure'] / 1e9:.5g} GPa"
    assert peak in Text(result._repr_html_()).text


def test_tables_escape():
    shown = Text(html_table("<b>", [("<i>", "1 < 2 & 3")], "<u>"))
    assert shown.tags == ["div", "strong", "table", "tr", "th", "td", "p"]
    assert shown.text.split("\n") == ["<b>", "<i>1 < 2 & 3", "<u>"]


def test_each_use_of_the_tutorial_is_short_and_from_the_top_of_the_package():
    """The page is run when the site is built."""
    cells = re.findall(r"```\{code-cell\} ipython3\n(.*?)```", PAGE.read_text(encoding="utf-8"), flags=re.DOTALL)
    assert len(cells) > 10
    assert all(len(cell.splitlines()) < 15 for cell in cells)
    assert not re.search(r"eigencontact\.\w", "".join(cells))
    assert set(re.findall(r"\bec\.(\w+)", "".join(cells))) <= set(ec.__all__)
