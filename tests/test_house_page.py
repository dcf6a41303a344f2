"""The architecture page: its map lists every room; each file of a walk is imported by an earlier one."""

import ast
import re
from functools import cache
from pathlib import Path

import pytest

from eigencontact.plugin import KINDS

ROOT = Path(__file__).resolve().parent.parent
PAGE = (ROOT / "docs/about/house.md").read_text(encoding="utf-8")
ROOTS = {"eigencontact": "framework", "eigencontact_plugins": "plugins", "eigencontact_verification": "verification"}
WALK = re.compile(r"^### (.+?)\n(.*?)(?=^##|\Z)", re.DOTALL | re.MULTILINE)
LINE = re.compile(r"^\d+\. `([^`]+\.py)`", re.MULTILINE)
COUNT = re.compile(r"^\| \[(.+?)\]\(#.+?\) \| .+ \| (\d+) \|$", re.MULTILINE)
REGISTRY = ROOT / "framework/eigencontact/hooks/registry.py"
WALKS = {title: [ROOT / name for name in LINE.findall(body)] for title, body in WALK.findall(PAGE) if LINE.search(body)}


def module_file(name):
    """File of a module of this repository, by its dotted name; None for any other name."""
    root = ROOTS.get(name.split(".")[0])
    if root is None:
        return None
    path = ROOT.joinpath(root, *name.split("."))
    files = (path.with_suffix(".py"), path / "__init__.py")
    return next((file for file in files if file.is_file()), None)


@cache
def imported(file):
    """Files that a file imports, inside its functions too; names of a package lead to the file that defines them."""
    files = set()
    for node in ast.walk(ast.parse(file.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            files |= {module_file(alias.name) for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            files |= {source(node.module, alias.name) for alias in node.names}
    return files - {None}


def source(module, name):
    """File that ``from module import name`` leads to."""
    file = module_file(f"{module}.{name}") or module_file(module)
    if file is None or file.name != "__init__.py":
        return file
    for node in ast.parse(file.read_text(encoding="utf-8")).body:
        if isinstance(node, ast.ImportFrom) and name in {alias.asname or alias.name for alias in node.names}:
            return source(node.module, name)
    return file


def registered():
    """Plugin files that the registry loads by their entry points."""
    text = (ROOT / "pyproject.toml").read_text(encoding="utf-8").split("[project.entry-points.eigencontact]")[1]
    return {module_file(name) for name in re.findall(r'= "([\w.]+)"', text.split("\n[")[0])}


@pytest.mark.parametrize("title", WALKS)
def test_an_earlier_file_of_a_walk_imports_each_file(title):
    walk = WALKS[title]
    assert len(set(walk)) == len(walk)
    for number, file in enumerate(walk):
        assert file.is_file(), file
        reached = set().union(*map(imported, walk[:number]))
        if REGISTRY in reached:
            reached |= registered()
        assert number == 0 or file in reached, f"no earlier file imports {file.relative_to(ROOT)}"


def test_the_page_has_four_walks_and_counts_their_files():
    assert len(WALKS) == 4
    stated = {title: int(count) for title, count in COUNT.findall(PAGE)}
    assert stated == {title: len(walk) for title, walk in WALKS.items()}


@pytest.mark.parametrize(
    "folder",
    [
        "framework/eigencontact",
        "framework/eigencontact/execution",
        "plugins/eigencontact_plugins",
        "verification/eigencontact_verification",
    ],
)
def test_the_map_has_one_line_for_each_room(folder):
    title = re.escape(f"`{folder}/`")
    table = re.search(rf"^### .*{title}.*?\n(.*?)(?=^##|\Z)", PAGE, re.DOTALL | re.MULTILINE)[1]
    rooms = re.findall(r"^\| `(\w+)/` \|", table, re.MULTILINE)
    assert sorted(rooms) == sorted(path.parent.name for path in (ROOT / folder).glob("*/__init__.py"))


def test_a_new_kind_of_plugin_changes_at_most_eight_files():
    section = PAGE.split("## Add a kind of plugin")[1]
    places = [ROOT / name for name in re.findall(r"^\| `(.+?)` \|", section, re.MULTILINE)]
    assert len(places) <= 8
    assert all(place.is_file() for place in places)
    # Nothing else in the program lists the kinds.
    kind_of = {cls.__name__: kind for kind, cls in KINDS.items()}
    kinds, classes = "|".join(KINDS), "|".join(kind_of)
    names = re.compile(rf"[\"'`](?P<kind>{kinds})[\"'`]|\b(?P<cls>{classes})\b")
    for folder in ("framework", "plugins", "verification", "docs/_ext"):
        for file in (ROOT / folder).rglob("*.py"):
            text = file.read_text(encoding="utf-8")
            listed = len({match["kind"] or kind_of[match["cls"]] for match in names.finditer(text)})
            assert listed <= len(KINDS) - 3 or file in places, f"{file.relative_to(ROOT)} names {listed} kinds"
