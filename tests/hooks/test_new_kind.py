"""A kind of plugin that nobody has heard of: its class and one field of the scene are enough for the scene's rooms."""

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import Annotated, Any, ClassVar

import pytest

from eigencontact.errors import SceneError
from eigencontact.hooks.registry import Registry
from eigencontact.plugin import KINDS, Component, DataFile
from eigencontact.reference.forms import kinds_within
from eigencontact.reference.keys import keys_of
from eigencontact.scene.components import build_component
from eigencontact.scene.files import anchored
from eigencontact.scene.schema import Scene
from eigencontact.scene.table import ComponentTable, OfKind

CONTACT = {
    "body1": {"young_modulus": "210 GPa", "poisson_ratio": 0.3},
    "geometry": {"type": "sphere", "radius": "1 mm"},
    "steps": {"normal_load": "1 N"},
}


class LubricantLaw(Component, ABC):
    kind: ClassVar[str] = "lubricant-law"

    @abstractmethod
    def viscosity(self, pressure):
        """Viscosity [Pa s]."""


@dataclass(frozen=True, kw_only=True)
class Newtonian(LubricantLaw):
    """Constant viscosity."""

    key: ClassVar[str] = "newtonian"

    value: float
    file: DataFile | None = None

    def viscosity(self, pressure):
        return self.value + 0 * pressure


class Lubricant(ComponentTable):
    """Lubricant with a key of the scene beside those of the plugin."""

    kind: ClassVar[str] = "lubricant-law"

    starved: bool = False

    def check_in(self, scene):
        if self.starved and scene.friction is None:
            raise ValueError("!lubricant.starved must be false without friction (got true); add [friction]")


class Lubricated(Scene):
    lubricant: Annotated[dict[str, Any] | None, OfKind("lubricant-law")] = None


class WithTable(Scene):
    lubricant: Lubricant | None = None


@pytest.fixture
def registry():
    registry = Registry({**KINDS, "lubricant-law": LubricantLaw})
    registry.add(Newtonian, package="oil", version="1")
    return registry


@pytest.mark.parametrize("table", [{"type": "newtonian", "value": "0.1"}, Newtonian(value=0.1)])
def test_a_table_and_a_component_are_the_same(table, registry):
    scene = Lubricated(**CONTACT, lubricant=table)
    assert build_component(registry, "lubricant-law", scene.lubricant, "lubricant") == Newtonian(value=0.1)
    beside = WithTable(**CONTACT, lubricant=table).lubricant
    built = build_component(registry, "lubricant-law", beside.component, "lubricant", beside.beside)
    assert built == Newtonian(value=0.1)


def test_data_files_of_it_count_from_the_folder_of_the_scene(registry, tmp_path):
    scene = Lubricated(**CONTACT, lubricant={"type": "newtonian", "value": 0.1, "file": "oil.txt"}).within(tmp_path)
    placed, files = anchored(scene, registry)
    assert placed.lubricant["file"] == str(tmp_path / "oil.txt")
    assert tmp_path / "oil.txt" in files


def test_the_reference_knows_it():
    for scene in (Lubricated, WithTable):
        (key,) = [key for key in keys_of(scene) if key.name == "lubricant"]
        kinds = [key.table.kind] if key.table else kinds_within(key.form)
        assert kinds == ["lubricant-law"]


def test_its_table_checks_itself_against_the_scene():
    with pytest.raises(SceneError, match=r"lubricant\.starved must be false without friction"):
        WithTable(**CONTACT, lubricant={"type": "newtonian", "value": 0.1, "starved": True})
