"""Pages that the build of the site writes: the gallery, links between scenes and plugins, formulas, notebooks."""

import json
import re
import sys
import tomllib
from pathlib import Path

import pytest

from eigencontact.scene.loader import bundled_names, bundled_text

ROOT = Path(__file__).parents[1]
sys.path.insert(0, str(ROOT / "docs" / "_ext"))

from gallery_page import CASE, LONGEST, scene_page  # noqa: E402 - lies with the site
from scene_uses import plugins_of, scenes_by_plugin  # noqa: E402 - lies with the site


@pytest.fixture
def page(tmp_path):
    """The page of a scene, as if its run had drawn two pictures and an animation."""

    def page(name):
        for file in ("pressure.png", "small-pressure.png", "section.png", "animation.gif"):
            (tmp_path / file).touch()
        captions = {"pressure.png": "Contact pressure.", "section.png": "Stress, a * b.", "animation.gif": "It moves."}
        run = {"seconds": 1.0, "output": "a line\n" * 500, "captions": captions}
        (tmp_path / "run.json").write_text(json.dumps(run), "utf-8")
        return scene_page(name, tomllib.loads(bundled_text(name)), tmp_path)

    return page


def test_every_picture_has_its_caption_and_the_animation_comes_first(page):
    text = page("hertz")
    figures = re.findall(r"\{figure\} pictures/hertz/(\S+)\n:alt: .+\n\n(.+)\n", text)
    assert figures == [
        ("animation.gif", "It moves."),
        ("section.png", "Stress, a \\* b."),
        ("pressure.png", "Contact pressure."),
    ]


@pytest.mark.parametrize("name", bundled_names())
def test_a_page_has_the_description_once_and_cuts_long_text(page, name):
    scene = tomllib.loads(bundled_text(name))
    text = page(name)
    assert not re.search(r"\b[Cc]ase [A-Z]{2}", text)
    assert "description =" not in text
    file, output = re.findall(r"```\{code-block\} \w+\n:class: no-search\n\n(.*?)\n```", text, re.DOTALL)
    assert max(len(block.splitlines()) for block in (file, output)) <= LONGEST
    assert f"The first {LONGEST} of 500 lines; `eigencontact run {name}` prints all." in text
    if len(file.splitlines()) < LONGEST:
        assert tomllib.loads(file) == {key: value for key, value in scene.items() if key != "description"}


def test_numbers_of_cases_are_left_out_and_sentences_stay_whole():
    assert CASE.sub("", "Case IC-3: the contact") == "the contact"
    assert CASE.sub("", "Case CO under gross sliding") == "under gross sliding"
    assert CASE.sub("", "Casehardened") == "Casehardened"
    assert CASE.sub("", "(case HZ-2: radius) and (elements, case IC-3): x") == "(radius) and (elements): x"


@pytest.mark.slow
def test_scenes_and_plugins_link_to_each_other(page):
    assert "[`geometry`](../reference/scene.md#geometry)" in page("coated-sphere")
    assert "{ref}`bonded-layers <plugin-layered-medium-bonded-layers>` (layered-medium)" in page("coated-sphere")
    assert "coated-sphere" in scenes_by_plugin()["layered-medium", "bonded-layers"]
    assert ("hardening-law", "swift") in plugins_of(tomllib.loads(bundled_text("plastic-indentation")))


def test_fractions_in_a_line_have_letters_of_full_size():
    pytest.importorskip("latex2mathml")
    pytest.importorskip("sphinx")
    from mathml import inline

    assert 'displaystyle="true"' in inline(r"\sqrt{\frac{a}{b}}")
    assert "displaystyle" not in inline("a + b")


def test_pages_with_cells_are_notebooks():
    pytest.importorskip("myst_nb")
    from notebooks import notebook_of

    cells = notebook_of((ROOT / "docs" / "start" / "first-scene.md").read_text("utf-8")).cells
    assert {cell.cell_type for cell in cells} == {"code", "markdown"}
    assert sum("eigencontact explain my.toml" in cell.source for cell in cells if cell.cell_type == "code") == 1
