"""Only files that this package wrote are ever replaced, whatever is asked for."""

import json
from shutil import copytree

import pytest

import eigencontact as ec
from close import close
from eigencontact.postprocess.stored_run import draw
from eigencontact.results.ownership import is_ours

pytestmark = pytest.mark.usefixtures("small_pictures")

COARSE = [
    "stress=[{shape='line', name='axis', start=[0,0,0], end=[0,0,1e-5], count=4}]",
    "grid.cells-per-contact-radius=6",
]


def scene(*changes):
    return ec.load_scene("hertz", [*COARSE, *changes])


def contents(folder):
    return {path.name: path.read_bytes() for path in folder.iterdir()}


@pytest.fixture(scope="module")
def finished(tmp_path_factory, small_pictures):
    """A run with pictures and VTK files, as this version writes it."""
    folder = tmp_path_factory.mktemp("finished")
    ec.run(scene("output.vtk=true"), folder)
    return folder


def test_everything_that_is_written_says_so(finished):
    found = {path.name for path in finished.iterdir()}
    assert {"results.nc", "summary.json", "pressure.png", "axis.png", "surface_0001.vti", "axis_0001.vtp"} <= found
    (finished / "summary.json").rename(finished / "summary.away")
    try:
        assert [path.name for path in finished.iterdir() if not is_ours(path) and path.suffix != ".away"] == []
    finally:
        (finished / "summary.away").rename(finished / "summary.json")
    assert is_ours(finished / "summary.json")


@pytest.mark.parametrize("overwrite", [False, True])
@pytest.mark.parametrize(
    "name",
    ["summary.json", "pressure.png", "Pressure.png", "axis.png", "surface_0001.vti", "surface.pvd", "axis_0007.vtp"],
)
def test_a_file_of_others_stops_a_run_before_it_begins(name, overwrite, tmp_path):
    (tmp_path / name).write_text('{"mine": true}')
    with pytest.raises(
        ec.EigencontactError, match=r" must be a file that eigencontact wrote, .*; move it away, .* -o$"
    ):
        ec.run(scene("output.vtk=true"), tmp_path, overwrite=overwrite)
    assert contents(tmp_path) == {name: b'{"mine": true}'}


def test_what_will_not_be_written_is_left_alone(tmp_path):
    kept = {"notes.txt": b"x", "holiday.png": b"x", "axis.csv": b"x", "surface_0001.vti": b"x", "axis.pvd": b"x"}
    for name, data in kept.items():
        (tmp_path / name).write_bytes(data)
    ec.run(scene("output.pictures=false", "output.vtk=false"), tmp_path)
    assert kept.items() <= contents(tmp_path).items()


def test_a_run_may_be_made_again_also_without_its_summary(finished, tmp_path):
    """A run killed between pictures and summary leaves pictures that no summary lists."""
    copytree(finished, tmp_path, dirs_exist_ok=True)
    (tmp_path / "summary.json").unlink()
    ec.run(scene("output.vtk=true"), tmp_path, resume=True)
    ec.run(scene("steps.normal-load=1"), tmp_path, overwrite=True)
    assert json.loads((tmp_path / "summary.json").read_text())["normal_load"] == close(1.0)


def test_pictures_of_an_earlier_version_are_known_by_the_summary(finished, tmp_path):
    copytree(finished, tmp_path, dirs_exist_ok=True)
    (tmp_path / "pressure.png").write_bytes(b"without a mark")
    ec.run(scene("output.vtk=true"), tmp_path)
    assert (tmp_path / "pressure.png").read_bytes().startswith(b"\x89PNG")


def test_plot_replaces_its_own_files_and_no_others(finished, tmp_path):
    for _ in range(2):
        draw(finished, tmp_path, vtk=True)
    (tmp_path / "axis.png").write_bytes(b"mine")
    before = contents(tmp_path)
    with pytest.raises(ec.EigencontactError, match=r"axis.png must be a file that eigencontact wrote"):
        draw(finished, tmp_path, vtk=True)
    assert contents(tmp_path) == before
