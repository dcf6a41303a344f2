"""Lower bounds of pyproject.toml, as the check of the lowest versions in .ci reads them."""

import re
import runpy
import tomllib
from importlib.metadata import version
from pathlib import Path

import pytest

ROOT = Path(__file__).parent.parent
CHECK = runpy.run_path(str(ROOT / ".ci" / "lowest_versions.py"))


@pytest.fixture
def project():
    return tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"]


def numbers(text):
    return [int(part) for part in re.findall(r"\d+", text)[:3]]


def test_every_requirement_has_a_bound_that_is_met_here(project):
    pins = CHECK["lowest"](project)
    assert len(pins) == len(project["dependencies"]) + len(project["optional-dependencies"]["test"])
    for pin in (pin for pin in pins if ";" not in pin):  # a marker may leave it out here
        name, bound = pin.split("==")
        assert numbers(bound) <= numbers(version(name)), pin


@pytest.mark.parametrize("requirement", ["numpy", "numpy>=2,<3", "numpy~=2.0", "numpy==2.0"])
def test_a_requirement_without_a_lower_bound_is_told(requirement, project):
    with pytest.raises(SystemExit, match="must be 'name>=version'"):
        CHECK["lowest"]({**project, "dependencies": [requirement]})


def test_the_run_is_that_of_readme():
    assert CHECK["first_run"]() == "eigencontact run hertz -o ."


def test_every_part_of_the_tests_exists():
    assert [name for name in CHECK["TESTS"] if not (ROOT / name).exists()] == []
