"""The authors' pages: their plugins keep all promises, their tables name what there is. The build runs their cells."""

import re
from functools import cache
from pathlib import Path

import pytest

from eigencontact.cli import app
from eigencontact.hooks.files import with_files
from eigencontact.plugin import KINDS
from eigencontact.scene.installed import installed_plugins
from eigencontact_verification.conformance import checks_for

PAGES = Path(__file__).resolve().parent.parent / "docs" / "plugins"
CELL = re.compile(r"^```\{code-cell\} ipython3\n%%writefile ((?!test_)\w+\.py)\n(.*?)^```", re.DOTALL | re.MULTILINE)
OTHERS = {"index", "checks", "exact-shape"}


@cache
def components():
    """Example of every plugin that a page writes, by page."""
    found = {}
    for page in sorted(PAGES.glob("*.md")):
        for name, text in CELL.findall(page.read_text(encoding="utf-8")):
            found[page.stem] = text, name
    return found


@pytest.fixture
def component(request, tmp_path):
    """The example of a page, of the class that its file registers."""
    text, name = components()[request.param]
    (tmp_path / name).write_text(text, encoding="utf-8")
    known = set(installed_plugins())
    (entry,) = set(with_files(installed_plugins(), [tmp_path / name])) - known
    ring = {"center": (0.0, 0.0, 3.0), "ring_radius": 2.0, "tube_radius": 0.5}  # the page lets lengths be tried
    return entry.component(**(ring if entry.key == "torus" else getattr(entry.component, "example", {})))


@pytest.mark.parametrize("component", sorted(components()), indirect=True)
def test_the_plugin_of_a_page_keeps_every_promise(component):
    for check in checks_for(component, installed=False):
        check(component)


def test_every_kind_has_a_page_and_a_file_to_copy():
    pages = {page.stem for page in PAGES.glob("*.md")} - OTHERS
    assert pages - {"shape"} | {"inclusion-shape"} == set(KINDS)
    assert set(components()) == pages | {"index", "exact-shape"}
    lines = (PAGES / "index.md").read_text(encoding="utf-8").split("| content |")[1].split("\n\n")[0].splitlines()
    rows = [line.split("|") for line in lines if line.startswith("| ") and "`" in line]
    assert {row[2].strip(" `") for row in rows} == set(KINDS)
    for row in rows:
        assert (PAGES / re.search(r"\((.+?)\)", row[3])[1]).is_file(), row
        assert (PAGES.parent.parent / "plugins" / row[4].strip(" `")).is_file(), row


def test_every_check_is_explained_and_no_other():
    from eigencontact_verification.conformance import kit

    page = (PAGES / "checks.md").read_text(encoding="utf-8")
    rows = [line.split("|")[1] for line in page.splitlines() if line.startswith("| `check_")]
    explained = {name for row in rows for name in re.findall(r"`(check_\w+)`", row)}
    groups = [kit._checks(kit.common), *kit._BY_KIND.values(), *kit._SLOW.values(), kit._OF_POTENTIALS, kit._OF_ABILITY]
    assert explained == {check.__name__ for checks in groups for check in checks}


def test_every_command_exists(root):
    known = {command.name or command.callback.__name__ for command in app.registered_commands}
    known |= {"gallery", "verify", "check", "sweep", "fatigue"}
    texts = [*(page.read_text(encoding="utf-8") for page in PAGES.glob("*.md"))]
    texts.append((root / "plugins" / "README.md").read_text(encoding="utf-8"))
    asked = {name for text in texts for name in re.findall(r"(?:^!|`|^)eigencontact ([a-z-]+)", text, re.MULTILINE)}
    assert {"check", "verify", "plugins", "new-plugin"} <= asked <= known


def test_what_the_quick_start_of_plugins_says_is_short(root):
    assert len((root / "plugins" / "README.md").read_bytes()) <= 2048
