import json
import os
import re
import subprocess
import sys
import textwrap
from pathlib import Path

import h5py
import numpy as np
import pytest
import xarray as xr

from eigencontact.errors import ResultsError, SceneError
from eigencontact.postprocess.stored_run import draw
from eigencontact.results import netcdf
from eigencontact.results.reader import open_results
from eigencontact.results.store import ResultStore
from results import synthetic

ALL_SHAPES = ("plane", "depth", "volume", "line", "points")


def names(folder):
    return sorted(path.name for path in folder.iterdir())


def filled(folder, info, records):
    store = ResultStore.create(folder, info)
    for record in records:
        store.write_step(record)
    return store


def same_mapping(expected, actual):
    assert set(expected) == set(actual)
    for name, value in expected.items():
        np.testing.assert_array_equal(actual[name], value, err_msg=name)
        assert np.asarray(actual[name]).dtype == np.asarray(value).dtype


def same_record(expected, actual):
    assert (expected.index, expected.time) == (actual.index, actual.time)
    for part in ("scalars", "observed", "fields"):
        same_mapping(getattr(expected, part), getattr(actual, part))
    assert set(expected.regions) == set(actual.regions)
    for name, region in expected.regions.items():
        other = actual.regions[name]
        assert (region.shape, region.body, region.dims) == (other.shape, other.body, other.dims)
        same_mapping(region.coords, other.coords)
        same_mapping(region.fields, other.fields)


@pytest.mark.parametrize(
    ("size", "count", "regions", "observed"),
    [
        ((24, 20), 1, (), False),
        ((7, 5), 3, ("plane",), True),
        ((1, 1), 2, ALL_SHAPES, True),
        ((24, 1), 1, ("line",), False),
    ],
)
def test_steps_come_back_bit_by_bit_before_and_after_finish(tmp_path, size, count, regions, observed):
    info = synthetic.info(nx=size[0], ny=size[1], steps=count)
    records = [
        synthetic.step(info, n, synthetic.LOAD * n / count, regions, observed=observed) for n in range(1, count + 1)
    ]
    store = filled(tmp_path / "run", info, records)
    assert store.accepted() == list(range(1, count + 1))
    for record in records:
        same_record(record, store.load_step(record.index))
    path = store.finish()
    assert names(tmp_path / "run") == ["results.nc"]
    assert store.accepted() == list(range(1, count + 1))
    for record in records:
        same_record(record, store.load_step(record.index))
    assert store.finish() == path


def test_single_precision_stays_single(tmp_path):
    info = synthetic.info()
    record = synthetic.step(info)
    record.fields["pressure"] = record.fields["pressure"].astype(np.float32)
    path = filled(tmp_path, info, [record]).finish()
    with open_results(path) as found:
        assert found["pressure"].dtype == np.float32
        assert found["gap"].dtype == np.float64


def test_xarray_opens_with_coordinates_units_and_provenance(tmp_path):
    info = synthetic.info(steps=2)
    records = [synthetic.step(info, n, n * 0.3, ("plane", "points"), observed=True) for n in (1, 2)]
    filled(tmp_path, info, records).finish()
    with xr.open_dataset(tmp_path / "results.nc", engine="h5netcdf") as found:
        assert found["pressure"].dims == ("step", "y", "x")
        assert found["plane_0_stress"].dims == ("step", "component", "plane_0_z", "plane_0_x")
        assert found["plane_0_principal"].dims == ("step", "principal", "plane_0_z", "plane_0_x")
        assert found["component"].values.tolist() == ["xx", "yy", "zz", "yz", "xz", "xy"]
        assert found["principal"].values.tolist() == [1, 2, 3]
        assert {"time", "x", "y", "step", "plane_0_y", "points_1_z"} <= set(found.coords)
        assert "plane_0_y" in found["plane_0_von_mises"].coords
        np.testing.assert_array_equal(found["x"], info.grid.x)
        np.testing.assert_array_equal(found["time"], [1.0, 2.0])
        assert not [name for name, v in found.variables.items() if not {"units", "long_name"} <= set(v.attrs)]
        assert (found["pressure"].attrs["units"], found["contact_area"].attrs["units"]) == ("Pa", "m2")
        assert found["plane_0_von_mises"].attrs["body"] == 1
        assert found.attrs["scene"] == info.scene_toml
        assert found.attrs["scene_hash"] == info.scene_hash
        assert json.loads(found.attrs["versions"]) == info.versions
        assert found.attrs["references"].splitlines() == list(info.references)
        assert (found.attrs["title"], found.attrs["Conventions"][:3]) == ("Sphere", "CF-")
        assert found.attrs["created"].endswith("+00:00")
        assert found.attrs["eigencontact_version"]


def test_quantity_of_some_steps_is_nan_in_the_others_and_absent_again_when_loaded(tmp_path):
    info = synthetic.info(steps=2)
    records = [synthetic.step(info, 1, reference=False), synthetic.step(info, 2)]
    store = filled(tmp_path, info, records)
    with open_results(store.finish()) as found:
        assert np.isnan(found["reference_pressure"][0]).all()
        np.testing.assert_array_equal(found["reference_pressure"][1], records[1].fields["reference_pressure"])
    assert "reference_pressure" not in store.load_step(1).fields


def test_large_fields_are_stored_as_they_are(tmp_path):
    info = synthetic.info(nx=512, ny=300)
    records = [synthetic.step(info, n, n * 0.3, regions=()) for n in (1, 2, 3)]
    path = filled(tmp_path, info, records).finish()
    with open_results(path) as found:
        for at, record in enumerate(records):
            np.testing.assert_array_equal(found["pressure"][at], record.fields["pressure"])
    assert path.stat().st_size < 1.02 * sum(field.nbytes for record in records for field in record.fields.values())


def test_bands_of_large_fields_that_are_zero_are_left_out_and_read_as_zero(tmp_path, monkeypatch):
    info = synthetic.info(nx=64, ny=250)
    monkeypatch.setattr(netcdf, "_LARGE", 1)
    monkeypatch.setattr(netcdf, "_BAND", 7 * 64 * 8)  # the last band is a shorter one
    first, second = (synthetic.step(info, n, n * 0.3, regions=("plane",)) for n in (1, 2))
    pressure = first.fields["pressure"]
    assert np.mean(pressure.any(axis=1)) < 0.8
    pressure[-1, 0] = 1.0  # nothing of a band is lost because most of it is zero
    del first.fields["gap"]  # what a step has not is missing, and not zero
    path = filled(tmp_path, info, [first, second]).finish()
    with open_results(path) as found:
        for name, values in second.fields.items():
            np.testing.assert_array_equal(found[name][1], values)
        np.testing.assert_array_equal(found["pressure"][0], pressure)
        assert np.all(np.isnan(found["gap"][0]))
        np.testing.assert_array_equal(found["plane_0_stress"][1], second.regions["plane_0"].fields["stress"])
    with h5py.File(path, "r") as file:
        assert file["pressure"].chunks == (1, 7, 64)
        assert 0 < file["pressure"].id.get_storage_size() < 0.9 * file["gap"].id.get_storage_size()


def test_long_scene_and_empty_title_survive(tmp_path):
    info = synthetic.info(title="")
    object.__setattr__(info, "scene_toml", "# " + "long " * 40_000)
    with open_results(filled(tmp_path, info, [synthetic.step(info)]).finish()) as found:
        assert (found.attrs["title"], found.attrs["scene"]) == ("", info.scene_toml)


def broken_rename(self, target):
    raise OSError(28, "No space left on device")


def test_kill_between_write_and_rename_leaves_complete_steps_only(tmp_path, monkeypatch):
    info = synthetic.info(steps=2)
    store = filled(tmp_path, info, [synthetic.step(info, 1)])
    with monkeypatch.context() as patch:
        patch.setattr(Path, "replace", broken_rename)
        with pytest.raises(ResultsError, match=r"^step 2 must be stored in .*got: No space left on device.*--resume"):
            store.write_step(synthetic.step(info, 2))
    assert names(tmp_path / "steps") == ["0001.step", "run.json"]
    (tmp_path / "steps" / ".0002.step.partial").write_bytes(b"half")
    again = ResultStore.create(tmp_path, info, resume=True)
    assert again.accepted() == [1]
    again.write_step(synthetic.step(info, 2))
    with open_results(again.finish()) as found:
        assert found.sizes["step"] == 2
    assert names(tmp_path) == ["results.nc"]


def test_kill_while_results_are_joined_keeps_the_steps(tmp_path, monkeypatch):
    info = synthetic.info()
    store = filled(tmp_path, info, [synthetic.step(info, 1)])
    with monkeypatch.context() as patch:
        patch.setattr(Path, "replace", broken_rename)
        with pytest.raises(ResultsError, match=r"^results must be stored in"):
            store.finish()
    assert names(tmp_path) == ["steps"]
    assert ResultStore.create(tmp_path, info, resume=True).finish().exists()


def test_the_only_step_of_a_run_is_stored_as_results_at_once(tmp_path, monkeypatch):
    info = synthetic.info(steps=1)
    record = synthetic.step(info)
    store = ResultStore.create(tmp_path, info)
    with monkeypatch.context() as patch:  # killed before the rename, or the disk is full
        patch.setattr(Path, "replace", broken_rename)
        with pytest.raises(ResultsError, match=r"^results must be stored in"):
            store.write_step(record)
    assert names(tmp_path) == ["steps"]
    assert names(tmp_path / "steps") == ["run.json"]
    (tmp_path / ".results.nc.partial").write_bytes(b"half")  # killed while it was written
    again = ResultStore.create(tmp_path, info, resume=True)
    assert again.accepted() == []
    again.write_step(record)
    assert names(tmp_path) == ["results.nc"]
    assert again.finish() == tmp_path / "results.nc"
    resumed = ResultStore.create(tmp_path, info, resume=True)
    assert resumed.accepted() == [1]
    same_record(record, resumed.load_step(1))
    assert resumed.history(record) == [record.row()]


def test_interrupt_while_writing_is_passed_on_and_leaves_nothing(tmp_path, monkeypatch):
    info = synthetic.info()
    store = filled(tmp_path, info, [])
    monkeypatch.setattr(os, "fsync", lambda _handle: (_ for _ in ()).throw(KeyboardInterrupt))
    with pytest.raises(KeyboardInterrupt):
        store.write_step(synthetic.step(info))
    assert names(tmp_path / "steps") == ["run.json"]


FILL = """
    import resource, signal, sys
    from pathlib import Path
    from results import synthetic
    from eigencontact.errors import ResultsError
    from eigencontact.results.store import ResultStore

    info = synthetic.info(nx=300, ny=300, steps=3)
    store = ResultStore.create(Path(sys.argv[1]), info)
    store.write_step(synthetic.step(info, 1))
    if sys.argv[2] == "kill":
        import os
        os.replace = lambda *paths: os.kill(os.getpid(), signal.SIGKILL)
    else:
        signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
        resource.setrlimit(resource.RLIMIT_FSIZE, (2_000_000, 2_000_000))
    try:
        store.write_step(synthetic.step(info, 2))
    except ResultsError as error:
        print(error)
        sys.exit(5)
"""


@pytest.mark.skipif(os.name != "posix", reason="limits and signals of POSIX")
@pytest.mark.parametrize(("how", "code"), [("kill", -9), pytest.param("full", 5, marks=pytest.mark.slow)])
def test_real_kill_and_real_write_failure(tmp_path, how, code):
    folder = tmp_path / "run"
    paths = os.pathsep.join([str(Path(__file__).parents[1]), *filter(None, [os.environ.get("PYTHONPATH")])])
    done = subprocess.run(
        [sys.executable, "-c", textwrap.dedent(FILL), str(folder), how],
        capture_output=True,
        text=True,
        check=False,
        env={**os.environ, "PYTHONPATH": paths},
    )
    assert (done.returncode, done.stderr) == (code, "")
    if how == "full":
        assert done.stdout.startswith("step 2 must be stored in")
        assert "File too large" in done.stdout
        assert names(folder / "steps") == ["0001.step", "run.json"]
    store = ResultStore.create(folder, synthetic.info(nx=300, ny=300, steps=3), resume=True)
    assert store.accepted() == [1]
    assert store.problems == []


def cut(path):
    path.write_bytes(path.read_bytes()[:-2000])


def flip(path):
    """Change one byte of an array, as a failing disk would."""
    record = synthetic.step(synthetic.info(steps=3), 2)
    data = bytearray(path.read_bytes())
    at = data.index(record.fields["gap"].tobytes()[:64])
    data[at + 20] ^= 0xFF
    path.write_bytes(bytes(data))


@pytest.mark.parametrize(
    ("damage", "message"),
    [
        (cut, "0002.step must be a results file complete"),
        (flip, "0002.step must be a results file complete"),
        (lambda path: path.write_text("not HDF5"), "0002.step must be a results file complete"),
        (lambda path: path.write_bytes((path.parent / "0001.step").read_bytes()), "holding step 2 .got: steps .1.."),
        (lambda path: path.unlink(), "step 2 is missing"),
    ],
    ids=["cut", "flipped", "foreign", "another step", "missing"],
)
def test_damaged_step_is_reported_and_recomputed(tmp_path, damage, message):
    info = synthetic.info(steps=3)
    filled(tmp_path, info, [synthetic.step(info, n) for n in (1, 2, 3)])
    damage(tmp_path / "steps" / "0002.step")
    store = ResultStore.create(tmp_path, info, resume=True)
    assert store.accepted() == [1]
    assert len(store.problems) == 1
    assert re.search(message, store.problems[0])
    with pytest.raises(ResultsError):
        store.load_step(2)
    for n in (2, 3):
        store.write_step(synthetic.step(info, n))
    assert store.accepted() == [1, 2, 3]
    assert store.problems == []


def test_step_of_another_scene_is_not_used(tmp_path):
    other = synthetic.info(scene_hash="b" * 64)
    filled(tmp_path / "other", other, [synthetic.step(other)])
    info = synthetic.info()
    store = filled(tmp_path / "run", info, [])
    (tmp_path / "run/steps/0001.step").write_bytes((tmp_path / "other/steps/0001.step").read_bytes())
    assert store.accepted() == []
    assert "of this scene" in store.problems[0]


OTHER = "b" * 64


@pytest.mark.parametrize(
    ("stored", "scene", "resume", "overwrite", "outcome"),
    [
        ("nothing", "same", True, False, []),
        ("steps", "same", True, False, [1]),
        ("steps", "same", False, True, []),
        ("steps", "same", False, False, "unfinished run .got steps .1. .*--resume continues it, --overwrite .*-o"),
        ("steps", "other", True, False, "another scene.*--resume continues the same scene only; --overwrite.*-o"),
        ("steps", "other", False, False, "another scene.*--overwrite replaces them, another -o keeps them"),
        ("steps", "other", False, True, []),
        ("results", "same", True, False, [1]),
        ("results", "same", False, False, []),
        ("results", "other", True, False, "another scene.*--resume continues the same scene only"),
        ("results", "other", False, False, "another scene.*--overwrite replaces them, another -o keeps them"),
        ("results", "other", False, True, []),
        ("results", "same", True, True, "continued or replaced, not both"),
    ],
)
def test_what_resume_and_overwrite_do(tmp_path, stored, scene, resume, overwrite, outcome):
    info = synthetic.info()
    if stored != "nothing":
        store = filled(tmp_path, info, [synthetic.step(info)])
        if stored == "results":
            store.finish()
    asked = synthetic.info(scene_hash=info.scene_hash if scene == "same" else OTHER)
    before = sorted(tmp_path.rglob("*"))
    if isinstance(outcome, str):
        with pytest.raises(SceneError if resume and overwrite else ResultsError, match=outcome):
            ResultStore.create(tmp_path, asked, resume=resume, overwrite=overwrite)
        assert sorted(tmp_path.rglob("*")) == before
    else:
        again = ResultStore.create(tmp_path, asked, resume=resume, overwrite=overwrite)
        assert again.accepted() == outcome
        assert again.finished == (stored == "results" and resume)
        assert (tmp_path / "results.nc").exists() == (stored == "results" and not overwrite)


def test_overwrite_removes_only_what_this_package_wrote(tmp_path):
    info = synthetic.info()
    folder = tmp_path / "run"
    filled(folder, info, [synthetic.step(info)]).finish()
    (tmp_path / "outside.txt").write_text("keep")
    for name in ("notes.txt", "pressure.png", "holiday.png"):
        (folder / name).write_text("x")
    files = ["results.nc", "pressure.png", "../outside.txt"]
    (folder / "summary.json").write_text(json.dumps({"scene_hash": info.scene_hash, "files": files}))
    ResultStore.create(folder, synthetic.info(scene_hash=OTHER), overwrite=True)
    assert names(folder) == ["holiday.png", "notes.txt", "steps"]
    assert (tmp_path / "outside.txt").exists()


def foreign_results(folder):
    (folder / "results.nc").write_text("mine")


def foreign_netcdf(folder):
    xr.Dataset({"a": 1}).to_netcdf(folder / "results.nc", engine="h5netcdf")


def foreign_steps(folder):
    (folder / "steps").mkdir()
    (folder / "steps" / "dance.txt").write_text("left")


def foreign_mark(folder):
    (folder / "steps").mkdir()
    (folder / "steps" / "run.json").write_text("[]")


@pytest.mark.parametrize("plant", [foreign_results, foreign_netcdf, foreign_steps, foreign_mark])
@pytest.mark.parametrize("overwrite", [False, True])
def test_files_of_others_are_never_touched(tmp_path, plant, overwrite):
    plant(tmp_path)
    before = {path: path.read_bytes() for path in tmp_path.rglob("*") if path.is_file()}
    with pytest.raises(ResultsError, match=r" must be "):
        ResultStore.create(tmp_path, synthetic.info(), overwrite=overwrite)
    assert before == {path: path.read_bytes() for path in tmp_path.rglob("*") if path.is_file()}


@pytest.mark.parametrize("below", ["", "deeper/still"])
def test_unwritable_folder_is_one_clear_line(tmp_path, below):
    (tmp_path / "file").write_text("x")
    with pytest.raises(ResultsError, match=r"^output folder .* must be a folder that can be written .*-o$") as caught:
        ResultStore.create(tmp_path / "file" / below, synthetic.info())
    assert "\n" not in str(caught.value)
    assert names(tmp_path) == ["file"]


def test_writing_into_a_removed_folder_names_the_step(tmp_path):
    info = synthetic.info()
    store = filled(tmp_path / "run", info, [])
    (tmp_path / "run/steps/run.json").unlink()
    (tmp_path / "run/steps").rmdir()
    with pytest.raises(ResultsError, match=r"^step 1 must be stored in .*No such file"):
        store.write_step(synthetic.step(info))


def test_finish_refuses_gaps_no_steps_and_changed_regions(tmp_path):
    info = synthetic.info(steps=3)
    with pytest.raises(ResultsError, match=r"got \[\]"):
        filled(tmp_path / "none", info, []).finish()
    with pytest.raises(ResultsError, match=r"without a gap \(got \[1, 3\]\); --resume"):
        filled(tmp_path / "gap", info, [synthetic.step(info, n) for n in (1, 3)]).finish()
    records = [synthetic.step(info, 1), synthetic.step(info, 2, regions=("line",))]
    with pytest.raises(ResultsError, match=r"sub-surface points must be the same in all steps"):
        filled(tmp_path / "regions", info, records).finish()


def test_finish_with_a_damaged_step_says_so_and_keeps_the_rest(tmp_path):
    info = synthetic.info(steps=3)
    store = filled(tmp_path, info, [synthetic.step(info, n) for n in (1, 2, 3)])
    flip(tmp_path / "steps" / "0002.step")
    with pytest.raises(ResultsError, match=r"0002.step must be a complete step .*--resume .*keeps the steps before"):
        store.finish()
    assert names(tmp_path) == ["steps"]
    assert names(tmp_path / "steps") == ["0001.step", "0002.step", "0003.step", "run.json"]


@pytest.mark.parametrize("how", [cut, lambda path: path.write_bytes(path.read_bytes()[:40_000])])
@pytest.mark.parametrize("listed", [True, False])
def test_damaged_results_of_ours_are_named_and_overwritten(tmp_path, how, listed):
    info = synthetic.info()
    filled(tmp_path, info, [synthetic.step(info)]).finish()
    if listed:
        (tmp_path / "summary.json").write_text(json.dumps({"scene_hash": "a", "files": ["results.nc"]}))
    how(tmp_path / "results.nc")
    for resume in (False, True):
        with pytest.raises(
            ResultsError, match=r"results.nc must be .* complete .*; --overwrite replaces it, or .* -o$"
        ):
            ResultStore.create(tmp_path, info, resume=resume)
    with pytest.raises(ResultsError, match=r"run the scene again with --overwrite$"):
        open_results(tmp_path)
    store = ResultStore.create(tmp_path, info, overwrite=True)
    store.write_step(synthetic.step(info))
    with open_results(store.finish()) as found:
        assert found.sizes["step"] == 1


def test_damaged_data_of_finished_results_are_named_too(tmp_path):
    info = synthetic.info()
    filled(tmp_path, info, [synthetic.step(info)]).finish()
    with h5py.File(tmp_path / "results.nc", "r+") as file:
        del file["step"]
    store = ResultStore.create(tmp_path, info, resume=True)
    with pytest.raises(ResultsError, match=r"results.nc must be a results file complete"):
        store.accepted()


def test_a_damaged_mark_of_a_run_can_be_overwritten(tmp_path):
    info = synthetic.info()
    filled(tmp_path, info, [synthetic.step(info)])
    mark = tmp_path / "steps" / "run.json"
    mark.write_text(mark.read_text()[:-9])
    with pytest.raises(ResultsError, match=r"run.json must be the mark of a run .*--overwrite replaces it"):
        ResultStore.create(tmp_path, info, resume=True)
    assert ResultStore.create(tmp_path, info, overwrite=True).accepted() == []


@pytest.mark.parametrize(
    "change",
    [
        lambda file: file.attrs.update({"regions": "edited"}),
        lambda file: file.attrs.update({"regions": "[]"}),
        lambda file: file.attrs.update({"regions": '{"plane_0": {}}'}),
        lambda file: file.attrs.update({"regions": file.attrs["regions"].replace("plane_0", "plane_9")}),
        lambda file: file.attrs.update({"regions": file.attrs["regions"].replace("von_mises", "von_moses")}),
        lambda file: file.attrs.__delitem__("regions"),
        lambda file: file.__delitem__("plane_0_stress"),
    ],
)
def test_edited_regions_are_named(tmp_path, change):
    info = synthetic.info()
    path = filled(tmp_path, info, [synthetic.step(info)]).finish()
    with h5py.File(path, "r+") as file:
        change(file)
    with pytest.raises(ResultsError, match=r"results.nc must hold what it says of its regions .*--overwrite$"):
        open_results(tmp_path)
    with pytest.raises(ResultsError, match=r"results.nc must hold what it says of its regions"):
        draw(tmp_path)


def test_results_that_cannot_be_drawn_are_named(tmp_path):
    info = synthetic.info()
    path = filled(tmp_path, info, [synthetic.step(info)]).finish()
    with h5py.File(path, "r+") as file:
        file.attrs["regions"] = file.attrs["regions"].replace('["z", "x"]', '["z", "w"]')
    with pytest.raises(
        ResultsError, match=r"must hold results as this version writes them \(got KeyError: .*plane_0_w"
    ):
        draw(tmp_path, vtk=False)


@pytest.mark.parametrize(("name", "shape"), [("a/b", (20, 24)), ("x", (20, 24)), ("gap2", (3, 3))])
def test_names_that_clash_and_fields_that_do_not_fit_are_refused_before_writing(tmp_path, name, shape):
    info = synthetic.info()
    store = filled(tmp_path, info, [])
    record = synthetic.step(info)
    record.fields[name] = np.zeros(shape)
    with pytest.raises(ResultsError, match=r"must be"):
        store.write_step(record)
    assert store.accepted() == []


def test_reader_tells_nothing_interrupted_and_foreign_apart(tmp_path):
    info = synthetic.info(steps=2)
    filled(tmp_path / "run", info, [synthetic.step(info)])
    with pytest.raises(ResultsError, match=r"interrupted run with 1 stored steps.*--resume"):
        open_results(tmp_path / "run")
    with pytest.raises(ResultsError, match=r"must exist"):
        open_results(tmp_path / "nowhere")
    with pytest.raises(ResultsError, match=r"must exist"):
        open_results(tmp_path)
    foreign_netcdf(tmp_path)
    with pytest.raises(ResultsError, match=r"of format 'eigencontact-results-1' \(got None\)"):
        open_results(tmp_path)
    foreign_results(tmp_path)
    with pytest.raises(ResultsError, match=r"must be a complete results file"):
        open_results(tmp_path)
