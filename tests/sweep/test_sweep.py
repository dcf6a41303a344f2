"""Sweeps: what is varied, which variants run again, what fails without taking others along, one dataset of all."""

import csv
import errno
import json
import os
import signal
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

import eigencontact as ec
from close import close
from eigencontact.core.kept import ObjectCache, cached_object
from eigencontact.errors import EigencontactError, PlanError, ResultsError, SceneError
from eigencontact.execution.fields.traction_field import TractionField
from eigencontact.results.atomic import Sink
from eigencontact.sweeps.axes import axes_of, axis_of_text
from eigencontact.sweeps.folder import scene_digest, sweep_digest
from eigencontact.sweeps.gather import warnings_in_words
from eigencontact.sweeps.runner import outcomes
from eigencontact.sweeps.sweep import _scalars_to_draw, read_sweep_file, sweep
from eigencontact.sweeps.variants import on_one_grid, variants_of
from eigencontact.viz.sweep import draw_profiles, draw_sweep

pytestmark = pytest.mark.usefixtures("small_pictures")

#: Cells few enough for tests, in a window that holds the contacts of all variants.
SCENE = {
    "name": "ball",
    "body1": {"young-modulus": "210 GPa", "poisson-ratio": 0.3},
    "geometry": {"type": "sphere", "radius": "100 um"},
    "grid": {"cells": 32, "size": "30 um"},
    "steps": {"normal-load": "0.5 N"},
}


@pytest.mark.parametrize(
    ("text", "values"),
    [
        ("a=1,2,3", (1, 2, 3)),
        ("a=1 um, 2 um", ("1 um", "2 um")),
        ("a=[1, 2],[3, 4]", ([1, 2], [3, 4])),
        ("a='x,y',z", ("x,y", "z")),
        ("a=0:1:3", (0, 0.5, 1)),
        ("a=1:5:3", (1, 3, 5)),
        ("a=1 mm:3 mm:3", ("1 mm", "2 mm", "3 mm")),
        ("a=1e-3:10:5:log", (1e-3, 1e-2, 0.1, 1.0, 10.0)),
        ("a=true,false", (True, False)),
    ],
)
def test_values_of_a_text(text, values):
    assert axis_of_text(text).values == values


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("a", "--vary must be key=a,b,c or key=from:to:n"),
        ("a=", "--vary must be"),
        ("a=1 um:2 nm:3", "one unit at both ends"),
        ("a=1:2:0", "2 to 100000 values (got 0)"),
        ("a=1:2:x", "2 to 100000 values (got 'x')"),
        ("a=0:2:3:log", "above 0 to be spaced by logarithms"),
        ("a=1:2:3:lin", "from:to:n or from:to:n:log"),
        ("a=1,1", "each value once"),
    ],
)
def test_texts_that_are_refused(text, words):
    with pytest.raises(SceneError) as refused:
        axis_of_text(text)
    assert words in str(refused.value)


def test_a_key_is_varied_once_and_something_is():
    with pytest.raises(SceneError, match="each key once"):
        axes_of(["body1.poisson-ratio=0,0.1", "body1.poisson_ratio=0.2,0.3"])
    with pytest.raises(SceneError, match="must vary something"):
        axes_of({})


@pytest.fixture(scope="module")
def loads_and_radii(tmp_path_factory, small_pictures):
    folder = tmp_path_factory.mktemp("sweep")
    vary = {"steps.normal-load": ["0.125 N", "1 N"], "geometry.radius": {"from": "50 um", "to": "150 um", "count": 3}}
    return sweep(SCENE, vary, folder, fields=["pressure"])


@pytest.mark.slow
def test_numbers_are_those_of_single_runs(loads_and_radii):
    data = loads_and_radii.dataset
    assert data.max_pressure.dims == ("steps_normal_load", "geometry_radius")
    assert data.geometry_radius.values == close([50e-6, 100e-6, 150e-6], rel=1e-12)
    assert data.geometry_radius.attrs["units"] == "m"
    for load in (0.125, 1.0):
        for radius in (50e-6, 150e-6):
            tables = {"steps": {"normal-load": load}, "geometry": {"type": "sphere", "radius": radius}}
            alone = ec.run(SCENE | tables)
            here = data.sel(steps_normal_load=load, geometry_radius=radius, method="nearest")
            assert float(here.max_pressure) == close(alone.summary["max_pressure"], rel=1e-9)
            assert here.pressure.values == close(alone.dataset.pressure.values[-1], abs=1e3)


def test_loads_follow_hertz(loads_and_radii):
    """p0 ~ P^(1/3), so eight times the load is twice the pressure; 32 cells show it to some percent."""
    ratio = loads_and_radii.dataset.max_pressure.isel(steps_normal_load=1) / loads_and_radii.dataset.max_pressure[0]
    assert np.all(np.abs(ratio.values - 2.0) < 0.05)


def test_files_open(loads_and_radii):
    folder, files = loads_and_radii.folder, loads_and_radii.files
    assert set(files) <= {path.name for path in folder.iterdir()}
    with xr.open_dataset(folder / "sweep.nc", engine="h5netcdf") as stored:
        assert stored.max_pressure.equals(loads_and_radii.dataset.max_pressure)
        assert stored.pressure.attrs["units"] == "Pa"
    rows = list(csv.DictReader((folder / "sweep.csv").read_text(encoding="utf-8").splitlines()))
    assert [row["geometry.radius"] for row in rows] == ["50 um", "100 um", "150 um"] * 2
    assert float(rows[4]["max_pressure"]) == float(loads_and_radii.dataset.max_pressure[1, 1])
    assert len(json.loads((folder / "sweep.json").read_text(encoding="utf-8"))["variants"]) == 6
    assert (folder / "max_pressure.png").read_bytes()[:4] == b"\x89PNG"


def test_finished_variants_are_not_run_again(loads_and_radii, monkeypatch):
    folder = loads_and_radii.folder
    monkeypatch.setattr("eigencontact.app.run", lambda *_, **__: pytest.fail("ran again"))
    again = sweep(SCENE, {"steps.normal-load": ["1 N"], "geometry.radius": ["50 um", "100 um"]}, folder)
    assert again.failed == {}
    assert again.dataset.max_pressure.values == close(loads_and_radii.dataset.max_pressure.values[1:, :2], rel=1e-15)


def test_a_changed_scene_is_another_sweep(tmp_path):
    """It is refused with both hashes, and replaces the first one when it is told to."""
    vary = {"steps.normal-load": ["1 N"]}
    first = sweep(SCENE, vary, tmp_path)
    before = contents(tmp_path)
    larger = SCENE | {"geometry": {"type": "sphere", "radius": "200 um"}}
    hashes = [sweep_digest(ec.load_scene(scene), axes_of(vary), grid="own")[:16] for scene in (larger, SCENE)]
    with pytest.raises(ResultsError, match=rf"this sweep, scene hash {hashes[0]} .*hash {hashes[1]}.*--overwrite"):
        sweep(larger, vary, tmp_path)
    with pytest.raises(ResultsError, match="of other keys"):
        sweep(SCENE, {"geometry.radius": ["100 um"]}, tmp_path)
    assert contents(tmp_path) == before
    (tmp_path / "sweep.json").unlink()  # the dataset has the hash as well
    with pytest.raises(ResultsError, match=rf"scene hash {hashes[1]}.; --overwrite"):
        sweep(larger, vary, tmp_path)
    (tmp_path / "sweep.json").write_text('{"scene_hash"', encoding="utf-8")
    with pytest.raises(ResultsError, match=r"must hold a complete sweep \(got: .*--overwrite"):
        sweep(SCENE, vary, tmp_path)
    second = sweep(larger, vary, tmp_path, overwrite=True)
    assert float(second.dataset.max_pressure[0]) < 0.9 * float(first.dataset.max_pressure[0])
    assert sweep(larger, vary, tmp_path).dataset.max_pressure.equals(second.dataset.max_pressure)


def test_a_data_file_belongs_to_the_scene(tmp_path):
    """The tables stay the same when the file that they name changes."""
    np.save(tmp_path / "gap.npy", np.full((16, 16), 1e-7) * np.hypot(*np.mgrid[-8:8, -8:8]))
    scene = SCENE | {"geometry": {"type": "topography", "file": str(tmp_path / "gap.npy"), "height-unit": "m"},
                     "grid": {"cells": 16, "size": "30 um"}}  # fmt: skip
    axes = axes_of({"steps.normal-load": ["1 N"]})
    before = sweep_digest(ec.load_scene(scene), axes, grid="own"), scene_digest(ec.load_scene(scene))
    np.save(tmp_path / "gap.npy", np.full((16, 16), 2e-7))
    after = sweep_digest(ec.load_scene(scene), axes, grid="own"), scene_digest(ec.load_scene(scene))
    assert before[0] != after[0]
    assert before[1] != after[1]


def contents(folder):
    return {path: path.read_bytes() for path in sorted(folder.rglob("*")) if path.is_file()}


@pytest.mark.parametrize("name", ["sweep.nc", "sweep.csv", "sweep.json", "max_pressure.png"])
@pytest.mark.parametrize("overwrite", [False, True])
def test_files_of_others_are_never_replaced(tmp_path, name, overwrite):
    (tmp_path / name).write_text("a,b\n1,2\n", encoding="utf-8")
    with pytest.raises(ResultsError, match=rf"{name} must be a file that eigencontact wrote"):
        sweep(SCENE, {"steps.normal-load": ["1 N"]}, tmp_path, overwrite=overwrite)
    assert contents(tmp_path) == {tmp_path / name: b"a,b\n1,2\n"}


def test_the_run_of_another_in_the_folder_of_a_variant_is_kept(tmp_path):
    other = SCENE | {"geometry": {"type": "sphere", "radius": "200 um"}, "output": {"pictures": False, "vtk": False}}
    run_folder = tmp_path / "normal-load=1N"
    ec.run(other, run_folder)
    before = contents(run_folder)
    for _ in range(2):  # the refusal itself leaves nothing that makes the folder one of the sweep
        found = sweep(SCENE, {"steps.normal-load": ["1 N", "2 N"]}, tmp_path)
        assert "must be empty or of the scene" in found.failed["normal-load=1N"]
    assert contents(run_folder) == before


def cut(path):
    path.write_bytes(path.read_bytes()[:-100])


def flip(path):
    data = bytearray(path.read_bytes())
    data[len(data) // 2] ^= 0xFF
    path.write_bytes(bytes(data))


@pytest.mark.slow
def test_damaged_variants_are_computed_again(tmp_path):
    loads = [0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1.0]
    axes = axes_of({"steps.normal-load": loads})
    small = SCENE | {"grid": {"cells": 16, "size": "30 um"}}
    variants = variants_of(ec.load_scene(small), axes, pairs=False, pictures=False)
    first = [outcome.summary["max_pressure"] for outcome in outcomes(variants, tmp_path)]
    kept = (tmp_path / "normal-load=1.0" / "results.nc").stat().st_mtime_ns
    damages = [(name, damage) for name in ("results.nc", "summary.json") for damage in (cut, flip, Path.unlink)]
    for load, (name, damage) in zip(loads, damages, strict=False):
        damage(tmp_path / f"normal-load={load}" / name)
    again = list(outcomes(variants, tmp_path))
    assert [outcome.failed for outcome in again] == [""] * 7
    assert [outcome.summary["max_pressure"] for outcome in again] == first
    for outcome, (name, damage) in zip(again, damages, strict=False):
        assert f"{name} was {'missing' if damage is Path.unlink else 'damaged'}" in outcome.problem
    for variant, pressure in zip(variants, first, strict=True):
        with ec.open_results(tmp_path / variant.label) as stored:
            assert float(stored.max_pressure[-1]) == pressure
    assert (tmp_path / "normal-load=1.0" / "results.nc").stat().st_mtime_ns == kept
    assert [outcome.problem for outcome in outcomes(variants, tmp_path)] == [""] * 7


def test_an_interrupted_variant_is_run_again(tmp_path, monkeypatch):
    def interrupted(*_, **__):
        raise KeyboardInterrupt

    with monkeypatch.context() as patch:
        patch.setattr("eigencontact.app.run", interrupted)
        with pytest.raises(KeyboardInterrupt):
            sweep(SCENE, {"steps.normal-load": ["1 N"]}, tmp_path)
    failed = tmp_path / "normal-load=1N" / "failed.json"
    assert json.loads(failed.read_text(encoding="utf-8"))["failed"] == "it was interrupted"
    assert sweep(SCENE, {"steps.normal-load": ["1 N"]}, tmp_path).failed == {}
    assert not failed.exists()


def test_a_full_disk_is_said_once(tmp_path, monkeypatch):
    """It fills after the first variant: the next ones fail, and the sweep says that its dataset cannot be stored."""
    full = OSError(errno.ENOSPC, "No space left on device")
    outcomes_seen = []

    def fill(outcome, done, total):
        outcomes_seen.append(outcome.failed)
        monkeypatch.setattr(Sink, "write", lambda sink, _: setattr(sink, "error", full))
        monkeypatch.setattr(Path, "write_text", lambda *_, **__: (_ for _ in ()).throw(full))

    with pytest.raises(ResultsError, match=r"dataset of the sweep must be .*No space left.*running the sweep again"):
        sweep(SCENE, {"steps.normal-load": ["0.5 N", "1 N"]}, tmp_path, report_progress=fill)
    assert outcomes_seen[0] == ""
    assert "must be stored" in outcomes_seen[1]
    monkeypatch.undo()
    assert sweep(SCENE, {"steps.normal-load": ["0.5 N", "1 N"]}, tmp_path).failed == {}


@pytest.mark.parametrize(
    ("arguments", "options", "words"),
    [
        ((None,), {}, "vary must be a table of values by key, or an array of texts .*got None"),
        (("steps.normal-load=1,2",), {}, "vary must be a table of values by key, or an array of texts"),
        (([3],), {}, "vary must be a table of values by key, or an array of texts"),
        (({"steps.normal-load": np.array(1.0)},), {}, "vary.steps.normal-load must be an array of values"),
        (({"steps.normal-load": {"from": 1, "to": 2, "count": 2, "log": "no"}},), {}, "log must be true or false"),
        (({"steps.normal-load": [1]}, 3), {}, "folder must be a path, or None .*got 3"),
        (({"steps.normal-load": [1]},), {"fields": "pressure"}, "fields must be an array of names .got 'pressure'"),
        (({"steps.normal-load": [1]},), {"scalars": 3}, "scalars must be an array of names .got 3"),
        (({"steps.normal-load": [1]},), {"pairs": "yes"}, "pairs must be true or false .got 'yes'"),
        (({"steps.normal-load": [1]},), {"cluster": 3}, "cluster must be an address as text"),
        (({"grid.size": [np.ones(2), np.ones(2)]},), {}, "each value once"),
        (({"geometry.radius": ["abc", "def"]},), {}, r"2 failed; radius=abc: geometry.radius must be a length \[m\]"),
    ],
)
def test_arguments_that_are_refused(arguments, options, words):
    with pytest.raises(EigencontactError, match=words) as refused:
        sweep(SCENE, *arguments, **options)
    assert "\n" not in str(refused.value)


def test_a_value_that_is_no_quantity_fails_its_variant_alone(tmp_path):
    found = sweep(SCENE, {"geometry.radius": ["abc", "100 um"]}, tmp_path)
    assert list(found.failed) == ["radius=abc"]
    assert list(found.dataset.geometry_radius.values) == ["abc", "100 um"]
    assert np.isfinite(found.dataset.max_pressure.values[1])


def test_values_are_said_as_they_were_understood():
    said = []
    sweep(SCENE, ["steps.normal-load=0,5 N", "body1.young-modulus=1e11:3e11:3"], say=said.append)
    assert said == [
        "steps.normal-load: 2 values: 0 N, 5 N; a comma separates values: write decimals with a point",
        "body1.young-modulus: 3 values: 100 GPa, 200 GPa, 300 GPa",
    ]


def test_what_fails_is_told_and_stops_nothing(tmp_path):
    vary = {"body1.poisson-ratio": [0.3, 0.7, 0.5], "steps.normal-load": ["0.5 N", "500 N"]}
    found = sweep(SCENE, vary, tmp_path)
    assert len(found.failed) == 4
    assert "must be in (-1, 0.5]" in found.failed["poisson-ratio=0.7_normal-load=0.5N"]
    assert np.isfinite(found.dataset.max_pressure.values[[0, 2], 0]).all()
    assert np.isnan(found.dataset.max_pressure.values[:, 1]).all()  # more than the window can carry
    told = json.loads((tmp_path / "poisson-ratio=0.3_normal-load=500N" / "failed.json").read_text(encoding="utf-8"))
    assert told["failed"] == str(found.dataset.failed.values[0, 1])


def test_a_sweep_of_nothing_but_refused_variants_is_refused(tmp_path):
    with pytest.raises(SceneError, match=r"every variant of the sweep is refused; the first: .*did you mean 'steps'"):
        sweep(SCENE, {"stps.normal-load": [1.0, 2.0]}, tmp_path)


def test_pairs():
    vary = {"steps.normal-load": [0.1, 0.8], "geometry.radius": ["50 um", "100 um"]}
    found = sweep(SCENE, vary, pairs=True)
    assert found.dataset.max_pressure.dims == ("variant",)
    assert found.dataset.geometry_radius.dims == ("variant",)
    with pytest.raises(SceneError, match="as many values of each key"):
        sweep(SCENE, vary | {"body1.poisson-ratio": [0.3]}, pairs=True)


@pytest.mark.slow
def test_one_grid_for_all(tmp_path, monkeypatch):
    scene = {**SCENE, "grid": {"cells-per-contact-radius": 6}}
    vary = {"steps.normal-load": ["0.1 N", "0.8 N"]}
    with monkeypatch.context() as patch:
        patch.setattr("eigencontact.app.run", lambda *_, **__: pytest.fail("ran before it was refused"))
        with pytest.raises(PlanError, match=r"same cells .*--shared-grid") as told:
            sweep(scene, vary, fields=["pressure"])
    assert "'normal-load=0.1N' and " in str(told.value)
    found = sweep(scene, vary, tmp_path, fields=["pressure"], grid="shared")
    area = (found.dataset.x[1] - found.dataset.x[0]) * (found.dataset.y[1] - found.dataset.y[0])
    assert (found.dataset.pressure.sum(("x", "y")) * area).values == close([0.1, 0.8], rel=1e-6)


@pytest.mark.parametrize("boundary", ["non-periodic", "periodic", "periodic-y"])
def test_a_shared_grid_keeps_an_odd_number_of_cells_and_the_period(boundary):
    scene = {**SCENE, "grid": {"cells": [15, 15], "size": "20 um"}, "numerics": {"boundary": boundary}}
    if boundary == "periodic-y":
        scene["grid"]["datum-depth"] = "1 mm"
    axes = axes_of({"steps.normal-load": [0.5, 1.0]})
    shared = on_one_grid(variants_of(ec.load_scene(scene), axes, pairs=False, pictures=False))
    assert [ec.plan(variant.scene).grid.shape for variant in shared] == [(15, 15)] * 2


def test_a_shared_grid_does_not_change_a_period():
    scene = {**SCENE, "grid": {"cells": [16, 16], "size": "30 um"}, "numerics": {"boundary": "periodic"}}
    with pytest.raises(PlanError, match=r"keep the period .*got 3e-05 m along x in 'size=30um', 4\.12e-05 m"):
        sweep(scene, {"grid.size": ["30 um", "40 um"]}, fields=["pressure"], grid="shared")


def test_a_file_may_ask_for_one_grid(command, tmp_path):
    path = tmp_path / "vary.toml"
    path.write_text("""
        grid = "shared"
        fields = ["pressure"]
        scalars = ["approach"]
        vary = {"steps.normal-load" = ["0.1 N", "0.4 N"]}
        [scene]
        body1 = {young-modulus = "210 GPa", poisson-ratio = 0.3}
        geometry = {type = "sphere", radius = "100 um"}
        grid = {cells-per-contact-radius = 4}
        steps = {normal-load = "1 N"}
    """)
    done = command("sweep", path, "-o", tmp_path / "out")
    assert done.code == 0, done.err
    with xr.open_dataset(tmp_path / "out" / "sweep.nc", engine="h5netcdf") as stored:
        assert stored.pressure.dims == ("steps_normal_load", "y", "x")


def test_variants_share_what_they_agree_in(monkeypatch):
    """Spectra of stress are made once for all friction coefficients, and the stress is the same to the last bit."""
    made = []
    real = TractionField._operator
    monkeypatch.setattr(TractionField, "_operator", lambda *a, **k: (made.append(1), real(*a, **k))[1])
    section = {"name": "cut", "shape": "plane", "normal": "y", "depth-max": "10 um", "depth-cells": 6}
    scene = SCENE | {"stress": section, "friction": {"type": "coulomb", "coefficient": 0.3}, "steps": [
        {"normal-load": "0.5 N"}, {"shift-x": "1 um"}], "numerics": {"coupling": "partial"}}  # fmt: skip
    vary = {"steps.0.normal-load": ["0.5 N", "0.2 N"], "friction.coefficient": [0.1, 0.2]}
    shared = sweep(scene, vary).dataset.max_von_mises
    together = len(made)
    alone = [ec.run(ec.load_scene(scene, [f"steps.0.normal-load={load}", f"friction.coefficient={friction}"])).summary
             for load in (0.5, 0.2) for friction in (0.1, 0.2)]  # fmt: skip
    assert len(made) - together == 2 * together
    assert [float(value) for value in shared.values.ravel()] == [one["max_von_mises"] for one in alone]


def test_what_is_kept_is_bounded():
    kept = ObjectCache(limit=100)
    with kept.offered():
        for number in range(5):
            cached_object(lambda number=number: number, lambda: np.zeros(5))
        assert kept.nbytes == 80
        cached_object(lambda: 3, lambda: pytest.fail("made again"))
        cached_object(lambda: "large", lambda: np.zeros(13))  # would push all others out
    assert (kept.nbytes, kept.hits) == (80, 1)
    assert cached_object(lambda: pytest.fail("asked outside"), lambda: np.zeros(5)).size == 5


def test_an_unknown_field_names_the_nearest():
    with pytest.raises(EigencontactError, match=r"normal-load=0.1: field must be .*did you mean 'pressure'\?"):
        sweep(SCENE, {"steps.normal-load": [0.1]}, fields=["presure"])


@pytest.mark.parametrize("name", ["max_pressure", "approach"])
def test_figures_show_all_values(loads_and_radii, name):
    figure = draw_sweep(loads_and_radii.dataset, name)
    (axes,) = figure.axes
    assert len(axes.lines) == 3
    assert [text.get_text() for text in axes.get_legend().get_texts()] == ["50 µm", "100 µm", "150 µm"]
    assert axes.get_xlabel() == "steps.normal-load [N]"
    drawn, found = axes.lines[2].get_ydata(), loads_and_radii.dataset[name].values[:, 2]
    assert drawn[1] / drawn[0] == close(found[1] / found[0], rel=1e-12)


def test_profiles_of_all_variants_in_one_figure(loads_and_radii):
    """Lines along x of the row in the middle; a failed variant has none."""
    assert "pressure-profiles.png" in loads_and_radii.files
    data = loads_and_radii.dataset.copy(deep=True)
    data["pressure"][1, 2] = np.nan
    (axes,) = draw_profiles(data, "pressure").axes
    row = data.pressure.isel(y=15).values.reshape(6, -1)[:5]
    assert np.array([line.get_ydata() for line in axes.lines]) == close(1e-9 * row, rel=1e-12)
    labels = [text.get_text() for text in axes.get_legend().get_texts()]
    assert labels[:2] == ["125 mN, 50 µm", "125 mN, 100 µm"]
    assert axes.get_legend().get_title().get_text() == "steps.normal-load, geometry.radius"
    assert axes.get_xlabel() == "x [µm]"
    paired = xr.Dataset({"pressure": (("variant", "y", "x"), np.ones((2, 1, 3)), {"units": "Pa"})},
                        {"a": ("variant", [1.0, 2.0]), "y": [0.0], "x": [0.0, 1.0, 2.0]})  # fmt: skip
    (axes,) = draw_profiles(paired, "pressure").axes
    assert [text.get_text() for text in axes.get_legend().get_texts()] == ["1", "2"]


def test_a_map_of_two_parameters():
    values = np.outer(np.arange(1.0, 6.0), np.arange(1.0, 7.0))
    one = xr.DataArray(values, dims=("a", "b"), name="z", attrs={"units": "Pa"})
    data = xr.Dataset({"z": one}, {"a": np.geomspace(1.0, 1e4, 5), "b": np.linspace(0.0, 1.0, 6)})
    axes, bar = draw_sweep(data, "z").axes
    assert (axes.get_xscale(), axes.get_yscale()) == ("log", "linear")
    assert axes.collections[0].get_array().reshape(6, 5)[3, 2] == 12.0
    assert bar.get_ylabel() == "z [Pa]"


def test_numbers_that_differ_by_their_residual_alone_are_not_drawn():
    loads = xr.DataArray([0.5, 0.5 - 1e-16], dims="a")
    data = xr.Dataset({"normal_load": loads, "max_pressure": ("a", [1.0, 1.1])}, {"a": [1.0, 2.0]})
    for name in data.data_vars:
        data[name].attrs["headline"] = 1
    assert _scalars_to_draw(data, []) == ["max_pressure"]


def noise(size, spread, shape=None):
    values = 52.24e-9 * (1.0 + spread * np.random.default_rng(0).permutation(np.linspace(0.0, 1.0, size)))
    return values if shape is None else values.reshape(shape)


@pytest.mark.parametrize(
    ("spread", "error", "span", "words"),
    [
        (2e-4, 0.0064, 0.0128, "all values within 0.02 %; error of the worn volume 0.64 %"),
        (2e-4, None, 0.01, "all values within 0.02 %; the scale spans 1 %"),
        (0.02, 0.0064, None, ""),
    ],
)
@pytest.mark.parametrize("dims", [("a",), ("a", "b")])
def test_noise_is_drawn_as_noise(spread, error, span, words, dims):
    """Of values that differ by less than their error the scale spans twice this error, and the title says so."""
    shape = (5,) * len(dims)
    attrs = {"units": "m", "long_name": "largest depth"}
    data = {"max_worn_depth": (dims, noise(5 ** len(dims), spread, shape), attrs)}
    if error is not None:
        data["wear_error"] = (dims, np.full(shape, error))
    figure = draw_sweep(xr.Dataset(data, {dim: np.linspace(1.0, 2.0, 5) for dim in dims}), "max_worn_depth")
    axes = figure.axes[0]
    low, high = axes.get_ylim() if len(dims) == 1 else axes.collections[0].get_clim()
    assert axes.get_title() == "\n".join(filter(None, ("Largest depth", words)))
    if span is None:
        assert high - low < 1.2 * spread * 52.24 * 1.02
    else:
        assert (high - low) / (52.24 * (1.0 + spread)) == close(span, rel=1e-9)


def test_values_by_ratio_are_marked_one_by_one():
    one = xr.DataArray([1.0, 2.0, 3.0], dims="a", name="z", attrs={"units": "Pa"})
    (axes,) = draw_sweep(xr.Dataset({"z": one}, {"a": [0.25, 1.0, 4.0]}), "z").axes
    assert [text.get_text() for text in axes.get_xticklabels()] == ["0.25", "1", "4"]


def test_a_file_describes_a_sweep(tmp_path):
    path = tmp_path / "vary.toml"
    path.write_text('scene = "hertz"\npairs = true\n[vary]\nsteps.normal-load = [1, 2]\n"geometry.radius" = '
                    '{from = 1e-4, to = 2e-4, count = 2}\n')  # fmt: skip
    read = read_sweep_file(path)
    assert set(read["vary"]) == {"steps.normal-load", "geometry.radius"}
    assert [axis.values for axis in axes_of(read["vary"])] == [(1, 2), (1e-4, 2e-4)]
    path.write_text('scene = "hertz"\nvari = 1\n')
    with pytest.raises(SceneError, match=r"unknown key 'vari' in the sweep; .* did you mean 'vary'\?"):
        read_sweep_file(path)


@pytest.mark.slow
def test_workers_give_the_numbers_of_one_process(tmp_path):
    vary = {"steps.normal-load": [0.1, 0.2, 0.4], "geometry.radius": ["50 um", "150 um"]}
    alone, shared = sweep(SCENE, vary), sweep(SCENE, vary, tmp_path, workers=2)
    assert shared.failed == {}
    assert shared.dataset.max_pressure.values == close(alone.dataset.max_pressure.values, rel=1e-9)


@pytest.mark.slow
def test_a_worker_that_dies_costs_its_variant_alone(tmp_path):
    """A law that kills its process takes no other variant along: those are run again."""
    axes = axes_of({"steps.normal-load": [0.1, 0.2, 0.4]})
    variants = variants_of(ec.load_scene(SCENE), axes, pairs=False, pictures=False)
    found = []
    for outcome in outcomes(variants, tmp_path, workers=2):
        found.append(outcome)
        if len(found) == 1:
            for child in _children():
                os.kill(child, signal.SIGKILL)
    assert sorted(outcome.place for outcome in found) == [(0,), (1,), (2,)]
    assert all(outcome.failed == "" for outcome in found)


def _children():
    """Workers of this process; its tracker of resources lives on."""
    listed = Path(f"/proc/{os.getpid()}/task/{os.getpid()}/children")
    if not listed.exists():
        pytest.skip("this system does not list the children of a process")
    numbers = [int(number) for number in listed.read_text(encoding="ascii").split()]
    return [number for number in numbers if b"spawn_main" in Path(f"/proc/{number}/cmdline").read_bytes()]


def test_the_command_writes_and_tells(command, tmp_path):
    changes = ["--set", "stress=[]", "--set", 'grid={cells=16, size="30 um"}']
    vary = ["--vary", "steps.normal-load=0.1,0.4", "--vary", "geometry.radius=50 um,-1"]
    done = command("sweep", "hertz", *changes, *vary, "-o", tmp_path, "--scalar", "approach")
    assert done.code == 1
    assert "variant normal-load=0.1_radius=-1 failed: " in done.err
    assert "variant 4 of 4: " in done.err
    assert "approach.png" in done.out
    assert sorted(path.name for path in tmp_path.glob("*.png")) == ["approach.png"]
    refused = command("sweep", "hertz", *changes)
    assert (refused.code, refused.err.count("\n")) == (2, 1)


@pytest.mark.slow
def test_warnings_of_variants_are_told_once_a_code(tmp_path, command):
    """Few cells in the smaller contacts: the words are those of the run, the rows have the codes alone."""
    (tmp_path / "ball.toml").write_text(
        """
        body1 = { young-modulus = "210 GPa", poisson-ratio = 0.3 }
        geometry = { type = "sphere", radius = "100 um" }
        grid = { cells = 32, size = "60 um" }
        steps = { normal-load = "0.5 N" }
        """
    )
    arguments = (str(tmp_path / "ball.toml"), "--vary", "steps.normal-load=0.5 N,1 N,20 N")
    done = command("sweep", *arguments, "-o", tmp_path / "out")
    said = [json.loads(path.read_text())["warnings"] for path in sorted((tmp_path / "out").glob("*/summary.json"))]
    few = [one for row in said for one in row if one["code"] == "contact-cells"]
    assert len(said) == 3
    assert len(few) == 2
    line = f"2 of 3 variants warn: contact-cells: {few[0]['words']} (in 'normal-load=0.5N')"
    assert line in done.out.splitlines()
    assert few[0]["words"] != few[1]["words"]
    with (tmp_path / "out" / "sweep.csv").open(encoding="utf-8") as sheet:
        codes = [row["warnings"] for row in csv.DictReader(sheet)]
    assert ["contact-cells" in text for text in codes] == [True, True, False]
    with xr.open_dataset(tmp_path / "out" / "sweep.nc") as dataset:
        assert list(dataset["warnings"].values.ravel()) == codes
    content = json.loads(command("sweep", *arguments, "-o", tmp_path / "out", "--json").out)  # read again, not run
    assert sum("contact-cells" in str(row) for row in content["warnings"].values()) == 2
    memory = sweep(tmp_path / "ball.toml", {"steps.normal-load": ["0.5 N", "20 N"]})
    assert [one["code"] for one in next(iter(memory.warnings.values()))].count("contact-cells") == 1
    assert list(memory.dataset["warnings"].values.ravel())[1] == codes[2]


def test_warnings_in_words():
    """A code that a variant has twice counts once; one variant warns, two warn."""
    slow, few = ({"code": code, "words": f"{code} here", "error": None} for code in ("slow-place", "contact-cells"))
    again = {**slow, "words": "slow-place there"}
    assert warnings_in_words({"a": [slow, again], "b": [few], "c": [again]}, 4) == [
        "2 of 4 variants warn: slow-place: slow-place here (in 'a')",
        "1 of 4 variants warns: contact-cells: contact-cells here",
    ]
    assert warnings_in_words({}, 4) == []
