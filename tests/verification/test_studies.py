"""Studies: listed, run coarsely, resumed, drawn; refused by name."""

import json
import math
from dataclasses import replace

import pytest

import eigencontact as ec
from close import close
from eigencontact.errors import SceneError
from eigencontact_verification.studies.catalogue import find, names, studies
from eigencontact_verification.studies.study import run_study, write_study


def test_names_are_unique_and_variants_are_scenes():
    assert len(set(names())) == len(names())
    for study in studies():
        coarse, fine = study.variants(coarse=True), study.variants(coarse=False)
        assert 1 < len(coarse) <= len(fine)
        assert len({variant.label for variant in fine}) == len(fine)


def test_unknown_name_gets_the_nearest():
    with pytest.raises(SceneError, match=r"rolling-homogen.*did you mean 'rolling-homogeneous'"):
        find("rolling-homogenous")


def test_finished_variants_are_read_again(tmp_path):
    study = find("rolling-homogeneous")
    found = list(run_study(study, tmp_path, coarse=True))
    picture, numbers = write_study(study, found, tmp_path)
    for item in found:
        item.dataset.close()
    assert picture.stat().st_size > 10_000
    rows = json.loads(numbers.read_text(encoding="utf-8"))["variants"]
    assert rows[1]["largest von Mises / p0"] == close(0.620, rel=0.02)
    stamps = {path: path.stat().st_mtime_ns for path in tmp_path.rglob("*.nc")}
    again = list(run_study(study, tmp_path, coarse=True))
    assert [item.row for item in again] == [item.row for item in found]
    for item in again:
        item.dataset.close()
    assert stamps == {path: path.stat().st_mtime_ns for path in tmp_path.rglob("*.nc")}


@pytest.mark.parametrize(
    ("name", "blocks"),
    [
        ("cluster-stiffness", {"inhomogeneities", "normal-contact"}),
        ("sphere-radius", {"inhomogeneities", "normal-contact"}),
        ("two-spheres-spacing", {"inhomogeneities", "normal-contact"}),
        ("coating-pressure", {"inhomogeneities", "normal-contact"}),
        ("coating-thickness", {"normal-contact"}),
        ("coating-fretting", {"frictional-contact"}),
        ("plastic-friction", {"inhomogeneities", "frictional-contact"}),
        ("wear-fretting-loops", {"wear", "frictional-contact"}),
    ],
)
def test_scenes_can_be_planned(name, blocks):
    """One study of a kind; the last of its coarse variants."""
    plan = ec.plan(find(name).variants(coarse=True)[-1].scene)
    assert blocks <= {part.name for part in plan.parts}


def test_thick_coating_against_the_integral_equation(tmp_path):
    """Case PL-2 of the soft coating, read off coarse cells; and what is read agrees with the catalogue."""
    study = find("coating-thickness")
    chosen = replace(study, coarse=study.coarse[1:2])
    (found,) = run_study(chosen, tmp_path, coarse=True)
    found.dataset.close()
    assert found.row["integral equation: pressure"] == close(0.638, abs=1e-3)
    assert found.row["integral equation: area"] == close(1.568, abs=1e-3)
    assert found.row["pressure ratio"] == close(0.638, rel=0.005)
    assert found.row["area ratio"] == close(1.568, rel=0.02)


@pytest.mark.slow
@pytest.mark.parametrize("study", studies(), ids=names())
def test_coarse_studies_run_and_are_drawn(study, tmp_path):
    found = list(run_study(study, tmp_path, coarse=True))
    picture, numbers = write_study(study, found, tmp_path)
    for item in found:
        item.dataset.close()
    assert picture.stat().st_size > 10_000
    rows = json.loads(numbers.read_text(encoding="utf-8"))["variants"]
    assert all(math.isfinite(value) for row in rows for value in row.values() if not isinstance(value, str))
