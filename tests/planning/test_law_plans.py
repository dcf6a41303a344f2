"""Plans of bodies and regions with laws: `explain` names law, hardening and damage with their parameters."""

import pytest

import eigencontact as ec

SMALL = ["grid.cells=8", "numerics.inclusion-pitch='64 nm'", "steps=[{normal-load='10 uN'}]", "stress=[]"]


def facts(scene, changes=()):
    return ec.plan(ec.load_scene(scene, list(changes))).explain().split("\n\n")[1].splitlines()


def test_explain_names_the_law_its_hardening_and_its_damage_with_parameters():
    text = ec.plan(ec.load_scene("bone-indentation", [*SMALL, "body1.law.damage.length='40 nm'"])).explain()
    lines = text.split("\n\n")[1].splitlines()
    assert lines[0] == "bodies      body 1 of law 'j2', E = 18.6 GPa, ν = 0.3; body 2 rigid"
    assert lines[1:4] == [
        "law         body 1: j2, young-modulus 18.6 GPa, poisson-ratio 0.3, yield-on nominal",
        "              hardening: perfect, yield-stress 100 MPa",
        "              damage: exponential, length 40 nm, saturation 0.6, strain 0.02",
    ]
    assert "cells of material that yields (perfect) and is damaged (exponential)" in text


def test_explain_names_the_law_of_a_body_that_stays_elastic():
    lines = facts("bone-indentation", [*SMALL, "body1.law.hardening.yield-stress='100 GPa'", "observers=[]"])
    assert "body 1 of law 'j2'" in lines[0]
    assert "hardening: perfect, yield-stress 100 GPa" in lines[2]


def test_explain_gives_a_long_curve_by_its_count_and_back_stresses_each():
    strain, stress = [0.1 * number for number in range(12)], [1e10 + 1e7 * number for number in range(12)]
    law = (
        f"body1.law={{type='j2', hardening=[{{type='tabulated', strain={strain}, stress={stress}}}, "
        "{type='prager', modulus='1 GPa'}, {type='armstrong-frederick', modulus='2 GPa', recovery=10.0}]}"
    )
    lines = facts("bone-indentation", [*SMALL, law, "observers=[]"])
    assert [line.split(":")[0].strip() for line in lines[2:5]] == ["hardening"] * 3
    assert lines[2].endswith("tabulated, strain (12 values), stress (12 values)")
    assert "prager, modulus 1 GPa" in lines[3]


def test_explain_names_the_laws_of_regions_once_for_many_places():
    material = "{type='brittle', damage={type='mazars', threshold=1e-4, A=0.9, B=8e3}}"
    centers = "[[0, 0, '60 nm'], [0, '90 nm', '60 nm']]"
    grains = f"[{{name='grain', type='sphere', radius='40 nm', centers={centers}, material={material}}}]"
    body = "body1={young-modulus='18.6 GPa', poisson-ratio=0.3}"
    lines = facts("bone-indentation", [*SMALL, body, "observers=[]", f"inclusions={grains}"])
    assert lines[0].startswith("bodies      body 1 elastic, E = 18.6 GPa")
    assert lines[1].startswith("law         grain, 1 ... grain, 2, 2 regions: brittle")
    assert lines[2].endswith("damage: mazars, threshold 0.0001, A 0.9, B 8000")


@pytest.mark.parametrize("scene", ["hertz", "tilted-punch"])
def test_explain_of_elastic_bodies_has_no_line_of_laws(scene):
    assert not [line for line in facts(scene) if line.startswith("law ")]
