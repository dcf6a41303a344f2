"""Names that become folders, files and variables."""

import re
from pathlib import Path

import pytest

from eigencontact import EigencontactError, load_scene
from eigencontact.core.names import PICTURES, clashes, is_folder_name, to_folder_name
from eigencontact.core.quantities import QUANTITIES
from eigencontact.reference.numbers import known_numbers

UNSAFE = ["..", ".", ".hidden", "-o", "a/b", "a\\b", "a b", "end.", "con", "NUL.txt", "lpt1", "ü", "a\n", "a\x00"]


@pytest.mark.parametrize("name", UNSAFE)
def test_names_that_are_no_folder_are_refused(name):
    assert not is_folder_name(name)
    assert is_folder_name(to_folder_name(name))
    with pytest.raises(EigencontactError, match=r"^name must be a plain name: letters, digits, '_'"):
        load_scene(load_scene("hertz").resolved() | {"name": name})


@pytest.mark.parametrize("name", ["hertz", "run-1.5", "_x", "0", "a.b-c_d", "console"])
def test_names_that_are(name):
    assert is_folder_name(name)
    assert to_folder_name(name) == name
    assert load_scene(load_scene("hertz").resolved() | {"name": name}).label == name


def test_a_scene_named_two_points_writes_nothing(command, scene_file, tmp_path, monkeypatch):
    inner = tmp_path / "inner"
    inner.mkdir()
    path = scene_file()
    path.write_text('name = ".."\n' + path.read_text(encoding="utf-8"), encoding="utf-8")
    before = sorted(tmp_path.rglob("*"))
    monkeypatch.chdir(inner)
    outcome = command("run", path)
    assert outcome.code == 2
    assert "name must be a plain name" in outcome.err
    assert sorted(tmp_path.rglob("*")) == before


@pytest.mark.parametrize(
    ("file", "name"),
    [
        ("my scene", "my-scene"),
        ("Kugel (2)", "Kugel-2"),
        ("Böden", "Boden"),
        ("接触", "scene"),
        (".x", "x"),
        ("con", "scene-con"),
    ],
)
def test_a_file_may_be_called_anything(file, name, scene_file, monkeypatch, command):
    path = scene_file(name=file)
    monkeypatch.chdir(path.parent)
    assert load_scene(path).name == name
    assert command("run", path, "-q").code == 0
    assert (path.parent / name / "results.nc").is_file()


def suffixed():
    """Region names whose variables would be those of the surface or of a step."""
    parts = (
        "x",
        "y",
        "z",
        "point",
        "outline",
        "stress",
        "strain",
        "displacement",
        "von_mises",
        "tresca",
        "hydrostatic",
    )
    return sorted(
        {
            name.removesuffix(f"_{part}")
            for name in (*QUANTITIES, *known_numbers())
            for part in parts
            if name.endswith(f"_{part}")
        }
    )


def test_the_words_of_results_are_all_known():
    assert {"displacement", "shear", "slip", "max", "tilt"} <= set(suffixed())
    assert [name for name in (*suffixed(), *PICTURES, "surface") if not clashes(name)] == []


def test_the_pictures_are_all_known(root):
    text = "\n".join(path.read_text(encoding="utf-8") for path in (root / "framework/eigencontact/viz").glob("*.py"))
    of_bodies = re.findall(r'"([a-z-]+)\{second\[field\.body\]\}\.png"', text)
    names = {*re.findall(r'"([a-z-]+)\.png"', text), *of_bodies, *(f"{name}-second" for name in of_bodies)}
    assert names == set(PICTURES)


def test_every_region_of_the_gallery_keeps_its_name(root):
    import tomllib

    for path in (root / "framework/eigencontact/gallery").glob("*.toml"):
        stress = tomllib.loads(path.read_text(encoding="utf-8")).get("stress", [])
        for table in [stress] if isinstance(stress, dict) else stress:
            assert not clashes(table.get("name", "")), Path(path).name


@pytest.mark.parametrize("name", ["pressure", "Pressure", "surface", "displacement", "shear", "max", "tilt", "history"])
def test_a_region_takes_no_place_of_the_surface(name):
    with pytest.raises(EigencontactError, match=rf"^stress region must have a name that differs from .*got '{name}'"):
        load_scene("hertz", [f"stress.0.name={name}"])


def test_regions_differ_by_more_than_case():
    with pytest.raises(EigencontactError, match=r"must differ by more than case \(got 'section' and 'Section'\)"):
        load_scene("hertz", ["stress.1.name=Section"])
