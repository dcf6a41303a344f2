"""Plans with layered bodies: said in words, nothing of layers loaded without them, a broken medium named at once."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
import pytest

import eigencontact as ec
from eigencontact.errors import PluginError
from eigencontact.plugin import LayeredMedium, Material
from eigencontact.scene.installed import installed_plugins

COATED = {
    "type": "bonded-layers",
    "layers": [{"thickness": "2 um", "young-modulus": "420 GPa", "poisson-ratio": 0.3}],
    "substrate": {"young-modulus": "210 GPa", "poisson-ratio": 0.3},
}
PLANE = {"name": "cut", "shape": "plane", "depths": [0.0, 1e-6]}


def scene(medium=None, **more):
    return ec.Scene(
        **{
            "body1": {"medium": medium or COATED},
            "geometry": {"type": "sphere", "radius": 2e-5},
            "grid": {"cells": 16, "size": [6e-6, 6e-6]},
            "steps": {"normal-load": 0.1},
            **more,
        }
    )


def test_explain_says_layers_plugin_and_what_they_replace():
    planned = ec.plan(scene(stress=PLANE))
    text = planned.explain()
    assert "body 1 layered (plugin 'bonded-layers'): 2 um of E = 420 GPa, ν = 0.3; E = 210 GPa, ν = 0.3 below" in text
    assert "layered kernels of body 1 ('bonded-layers') instead of half-space kernels" in text
    assert {kernel.influence for kernel in planned.kernels} == {"bonded-layers"}
    costs = {block.name: block.cost for block in planned.blocks}
    assert costs["normal-contact"].seconds_once > 0
    assert costs["stress-cut"].seconds_once > 0
    assert "homogeneous-pressure" in costs
    assert "reference-pressure" not in costs
    left_out = {item.effect: item.reason for item in planned.left_out}
    assert "only the bare substrate" in left_out["closed form of the pressure"]
    assert any("Burmister" in reference for reference in planned.to_dict()["references"])


def test_many_layers_are_said_in_one_line():
    layers = [{**COATED["layers"][0], "thickness": f"{n} um"} for n in range(1, 31)]
    text = ec.plan(scene({**COATED, "layers": layers})).explain()
    assert "1 um of E = 420 GPa, ν = 0.3; 28 more layers; 30 um of E = 420 GPa, ν = 0.3; E = 210 GPa" in text


def test_two_bodies_name_the_plugins_of_both():
    steel = {"young-modulus": "210 GPa", "poisson-ratio": 0.3}
    planned = ec.plan(scene(body2=steel, stress=[PLANE, {**PLANE, "name": "other", "body": 2}]))
    named = {(kernel.response, kernel.influence) for kernel in planned.kernels}
    assert named == {
        ("displacement z", "pressure + bonded-layers"),
        ("stress (6 components)", "bonded-layers"),
        ("stress (6 components)", "pressure"),
    }


@pytest.mark.parametrize(
    ("body2", "level", "alike"),
    [
        ({"rigid": True}, "full", False),
        ({"medium": COATED}, "full", True),
        ({"young-modulus": "210 GPa", "poisson-ratio": 0.3}, "full", False),
        ({"rigid": True}, "partial", False),
    ],
)
def test_a_layered_body_couples_unless_the_other_is_like_it(body2, level, alike):
    sliding = [{"normal-load": 0.1}, {"shift-x": 1e-7}]
    friction = {"type": "coulomb", "coefficient": 0.3}
    planned = ec.plan(scene(body2=body2, friction=friction, steps=sliding, numerics={"coupling": level}))
    responses = [(kernel.response, kernel.traction) for kernel in planned.kernels]
    assert (("displacement z", "shear q_x") in responses) == (level == "full" and not alike)
    assert any("Dundurs' constant is 0" in item.reason for item in planned.left_out) == alike


STEEL = Material(young_modulus=210e9, poisson_ratio=0.3)


class Faulty(LayeredMedium):
    """Steel, up to what `fault` spoils."""

    key: ClassVar[str] = "faulty"
    references: ClassVar[tuple[str, ...]] = ("none",)
    surface_material = deep_material = STEEL

    @property
    def interfaces(self):
        return {"interfaces": (2.0, 1.0), "no interfaces": None}.get(self.fault, (1e-6,))

    def material_at(self, z, *, side="below"):  # noqa: ARG002
        return 210e9 if self.fault == "material" else STEEL

    def response(self, quantity, components, traction, kx, ky, z, *, side="below"):  # noqa: ARG002
        if self.fault == "raises":
            raise ZeroDivisionError("k")
        shape = np.broadcast_shapes(np.shape(kx), np.shape(ky))
        out = np.full((len(components), *shape), np.nan if self.fault == "nan" else 1e-12, dtype=complex)
        return out[0] if self.fault == "shape" else out


@dataclass(frozen=True, kw_only=True)
class FaultyMedium(Faulty):
    fault: str


FAULTS = {
    "interfaces": "interfaces of layered-medium 'faulty' of tests 0 must be positive and ascend (got (2.0, 1.0))",
    "no interfaces": "must tell its materials, interfaces and response (got TypeError",
    "material": "must be made of Materials (got 210000000000.0)",
    "raises": "must return without an exception (got ZeroDivisionError: k",
    "nan": "must be finite, of shape (1, 3, 3) for one component at 3 x 3 waves",
    "shape": "(got shape (3, 3))",
}


@pytest.mark.parametrize(("fault", "words"), FAULTS.items(), ids=FAULTS)
def test_a_broken_medium_is_named_when_planning(fault, words):
    registry = installed_plugins().copy()
    registry.add(FaultyMedium, package="tests", version="0")
    with pytest.raises(PluginError) as refused:
        ec.plan(scene({"type": "faulty", "fault": fault}), registry=registry)
    assert str(refused.value).startswith("body1.medium: ")
    assert "'faulty'" in str(refused.value)
    assert words in str(refused.value)
