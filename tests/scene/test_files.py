"""Data files by annotation: any field name, any depth, any component; relative to the scene, and part of its hash."""

import numpy as np
import pytest
import tomli_w

import eigencontact as ec
from bodies import STEEL_TABLE as STEEL
from eigencontact.scene.files import anchored
from eigencontact.scene.installed import installed_plugins
from stopping import Stop, Stopper

SPHERE = {"type": "sphere", "radius": 105e-6}
QUIET = {"pictures": False}
CHARTED = '''
from dataclasses import dataclass, field
from pathlib import Path
from typing import ClassVar
from eigencontact.plugin import DataFile, Length, Observer, hookimpl

@dataclass(frozen=True, kw_only=True)
class Chart:
    """A table in the table."""
    paper: DataFile
    height: Length = 1.0

@dataclass(frozen=True, kw_only=True)
class Charted(Observer):
    """Reads charts of any name."""

    key: ClassVar[str] = "charted"
    first_map: DataFile
    second_map: DataFile | None = None
    many: tuple[DataFile, ...] = ()
    pair: tuple[str, DataFile] | None = None
    charts: tuple[Chart, ...] = ()
    best: Chart | None = None
    file: str = "no annotation, no file"

    def observe(self, step):
        return {"sum": sum(len(Path(path).read_text()) for path in self.paths())}

    def paths(self):
        inner = [chart.paper for chart in (*self.charts, *([self.best] if self.best else []))]
        named = [self.first_map, *([self.second_map] if self.second_map else []), *self.many, *(self.pair or ())[1:]]
        return [*named, *inner]

@hookimpl
def eigencontact_register():
    return [Charted]
'''
TABLE = {
    "type": "charted",
    "first-map": "one.txt",
    "second_map": "two.txt",
    "many": ["three.txt", "one.txt"],
    "pair": ["three.txt", "four.txt"],
    "charts": [{"paper": "five.txt", "height": "2 um"}, {"paper": "sub/six.txt"}],
    "best": {"paper": "seven.txt"},
}
NAMES = ["one", "two", "three", "four", "five", "sub/six", "seven"]


def written(tables, folder, name="my"):
    path = folder / f"{name}.toml"
    path.write_text(tomli_w.dumps(tables), encoding="utf-8")
    return path


@pytest.fixture
def charted(install, tmp_path, monkeypatch):
    """A scene with an observer of a stranger that names seven files in all ways, in a folder that is not ours."""
    install(CHARTED)
    home = tmp_path / "home"
    (home / "sub").mkdir(parents=True)
    for name in NAMES:
        (home / f"{name}.txt").write_text(name)
    monkeypatch.chdir("/")
    return written(
        {
            "body1": STEEL,
            "geometry": SPHERE,
            "grid": {"cells": 12, "size": [16e-6, 16e-6]},
            "steps": [{"normal-load": 0.3}, {"normal-load": 0.65}],
            "observers": [TABLE, {"type": "probe", "points": [[0.0, 0.0]]}],
            "output": QUIET,
        },
        home,
    )


def test_files_are_found_by_annotation_wherever_they_stand(charted):
    home = charted.parent
    planned = ec.plan(ec.load_scene(charted))
    assert list(planned.model.files) == [
        home / f"{name}.txt" for name in ("one", "two", "three", "four", "five", "sub/six", "seven")
    ]
    observer = planned.model.observers[0].observer
    assert observer.first_map == str(home / "one.txt")
    assert observer.many == (str(home / "three.txt"), str(home / "one.txt"))
    assert observer.pair == ("three.txt", str(home / "four.txt"))  # a plain text beside a file
    assert [chart.paper for chart in observer.charts] == [str(home / "five.txt"), str(home / "sub/six.txt")]
    assert observer.charts[0].height == 2e-6
    assert observer.best.paper == str(home / "seven.txt")
    assert observer.file == "no annotation, no file"


def test_copies_and_changes_keep_the_folder(charted):
    scene = ec.load_scene(charted)
    for copy in (
        scene.model_copy(update={"title": "copy"}),
        ec.load_scene(scene, ["title=copy"]),
        ec.Scene(**scene.resolved()),
        ec.load_scene(charted, ["observers.0.first-map=two.txt"]),
    ):
        assert {path.parent for path in ec.plan(copy).model.files} == {charted.parent, charted.parent / "sub"}
    assert ec.load_scene({**ec.load_scene("hertz").resolved(), "stress": []}).folder is None


def test_anchoring_twice_is_anchoring_once(charted):
    once, files = anchored(ec.load_scene(charted), installed_plugins())
    twice, again = anchored(once, installed_plugins())
    assert (twice, again) == (once, files)
    assert once.resolved() == ec.load_scene(charted).resolved()


@pytest.mark.parametrize("name", NAMES)
def test_a_changed_file_is_another_scene(name, charted, tmp_path):
    out = tmp_path / "out"
    with pytest.raises(Stop):
        ec.run(ec.load_scene(charted), out, watcher=Stopper(2))
    (charted.parent / f"{name}.txt").write_text("changed")
    with pytest.raises(ec.EigencontactError, match="another scene"):
        ec.run(ec.load_scene(charted), out, resume=True)
    (charted.parent / f"{name}.txt").write_text(name)
    assert ec.run(ec.load_scene(charted), out, resume=True).summary["steps"] == 2


def lattice(path, value, **extra):
    axis = np.linspace(-5e-6, 5e-6, 5)
    fields = {name: np.full((5, 5, 5), value * scale) for name, scale in extra.items()}
    np.savez(path, x=axis, y=axis, z=axis + 5e-6, **fields)


def cube(path, value):
    """Surface of a cube around (0, 0, 2 um) as OFF."""
    corners = [(x, y, z) for z in (-value, value) for y in (-value, value) for x in (-value, value)]
    quads = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]
    faces = [triangle for a, b, c, d in quads for triangle in ((a, b, c), (a, c, d))]
    rows = [f"{x} {y} {z + 2}" for x, y, z in corners] + [f"3 {a} {b} {c}" for a, b, c in faces]
    path.write_text("\n".join(["OFF", f"8 {len(faces)} 0", *rows]) + "\n")


BALL = {"type": "sphere", "center": [0, 0, 2e-6], "radius": 1e-6}
HILL = np.sin(np.pi * np.arange(8) / 7)
GRID = {"cells": 8, "spacing": [1e-6, 1e-6]}
#: Tables of a scene that name the file "data.*" once, and what writes it with a value.
BUNDLED = {
    "topography": (
        {"geometry": {"type": "topography", "file": "data.npz"}, "steps": {"approach": 1e-8}},
        lambda path, value: np.savez(path, heights=value * 1e-6 * np.outer(HILL, HILL), dx=1e-6, dy=1e-6),
    ),
    "eigenstrain of an inclusion": (
        {"inclusions": [BALL | {"eigenstrain": {"type": "from-file", "file": "data.npz"}}]},
        lambda path, value: lattice(path, value, eigenstrain=1e-3),
    ),
    "patch of eigenstrain": (
        {"eigenstrain": [{"type": "from-file", "file": "data.npz", "depth": 2e-6, "layers": 2}]},
        lambda path, value: lattice(path, value, eigenstrain=1e-3),
    ),
    "layer": (
        {"inclusions": [{"type": "layer", "file": "data.npy", "size": [4e-6, 4e-6], "eigenstrain": 1e-3}]},
        lambda path, value: np.save(path, np.full((3, 3), value * 1e-6)),
    ),
    "polyhedron": (
        {"inclusions": [{"type": "polyhedron", "file": "data.off", "scale": "1 um", "eigenstrain": 1e-3}]},
        cube,
    ),
    "friction": (
        {"geometry": SPHERE, "friction": {"type": "coulomb-map", "file": "data.npz"}, "steps": {"normal-load": 5e-2}},
        lambda path, value: np.savez(
            path, x=np.array([-1e-3, 1e-3]), y=np.array([-1e-3, 1e-3]), coefficient=np.full((2, 2), 0.1 * value)
        ),
    ),
    "map of a material": (
        {"inclusions": [BALL | {"eigenstrain": 1e-3, "material": {"type": "map", "file": "data.npz"}}]},
        lambda path, value: lattice(path, value, young_modulus=100e9, poisson_ratio=0.2),
    ),
}


@pytest.mark.parametrize("case", BUNDLED)
def test_every_bundled_component_with_a_file_says_so(case, tmp_path, monkeypatch):
    tables, write = BUNDLED[case]
    (name,) = {f"data.{ending}" for ending in ("npz", "npy", "off") if f"'data.{ending}'" in repr(tables)}
    data = tmp_path / name
    write(data, 1.0)
    monkeypatch.chdir("/")
    path = written({"body1": STEEL, "grid": GRID, "output": QUIET} | tables, tmp_path)
    before = ec.plan(ec.load_scene(path))
    assert before.model.files == (data,)
    first = ec.run(before, tmp_path / "out").summary["scene_hash"]
    write(data, 0.5)
    with pytest.raises(ec.EigencontactError, match=r"got results of another scene"):
        ec.run(ec.load_scene(path), tmp_path / "out", resume=True)
    write(data, 1.0)
    again = ec.run(ec.load_scene(path), tmp_path / "out", resume=True).summary["scene_hash"]
    assert again == first


def test_every_bundled_field_called_file_is_a_data_file():
    """The other way round: none of ours was forgotten."""
    from dataclasses import fields
    from typing import get_type_hints

    from eigencontact.core.quantities import FileMark

    named = {
        (entry.kind, entry.key, item.name): FileMark()
        in _marks(get_type_hints(entry.component, include_extras=True)[item.name])
        for entry in installed_plugins()
        for item in fields(entry.component)
        if "file" in item.name and item.name != "profile"
    }
    assert len(named) == 11
    assert all(named.values()), named


def _marks(hint):
    from typing import get_args

    return [*getattr(hint, "__metadata__", ()), *(mark for part in get_args(hint) for mark in _marks(part))]


def test_files_of_the_gallery_keep_their_name():
    planned = ec.plan(ec.load_scene("rough-surface"))
    assert any(str(table.get("file")).startswith("gallery:") for table in planned.scene.geometry)
    assert [path.name for path in planned.model.files] == ["rough_surface.npz"]
    assert planned.model.files[0].is_file()


def test_what_is_not_installed_is_refused_as_before(scene_file):
    path = scene_file(geometry='type = "topographie"\nfile = "a.npz"')
    with pytest.raises(
        ec.EigencontactError, match=r"geometry: unknown geometry 'topographie'; .*did you mean 'topography'"
    ):
        ec.plan(ec.load_scene(path))
