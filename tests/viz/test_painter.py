import pytest

from eigencontact.app import load_scene
from eigencontact.errors import ResultsError
from eigencontact.results.store import ResultStore
from eigencontact.results.stored import open_stored
from eigencontact.viz import painter as module
from eigencontact.viz.figures import draw_all
from eigencontact.viz.painter import Painter, painter_of
from results import synthetic


@pytest.fixture(scope="module")
def results(tmp_path_factory):
    info = synthetic.info(nx=8, ny=6)
    store = ResultStore.create(tmp_path_factory.mktemp("run"), info)
    store.write_step(synthetic.step(info, 1, 0.2, ("plane", "line")))
    return store.finish()


def pictures(folder):
    return {path.name: path.read_bytes() for path in folder.iterdir()}


@pytest.mark.slow
def test_another_process_draws_the_same_pictures(results, tmp_path):
    beside, here = tmp_path / "beside", tmp_path / "here"
    beside.mkdir()
    here.mkdir()
    with Painter() as painter:
        painter.begin(results, beside, solid=True)
        with open_stored(results) as dataset:
            described = draw_all(dataset, here, solid=True)
        assert painter.finish() == described
    assert pictures(beside) == pictures(here)
    assert len(pictures(here)) == len(described) > 2


def test_parts_make_up_the_whole(results, tmp_path, monkeypatch):
    stored = []
    monkeypatch.setattr("eigencontact.viz.figures.save", lambda _figure, path, *_: stored.append(path.name))
    with open_stored(results) as dataset:
        described = [draw_all(dataset, tmp_path, share=(k, 3)) for k in range(3)]
    assert described[0] == described[1] == described[2]
    assert sorted(stored) == sorted(described[0])


def test_a_picture_that_cannot_be_stored_is_told_here(results, tmp_path):
    with Painter() as painter:
        painter.begin(results, tmp_path / "missing", solid=False)
        with pytest.raises(ResultsError, match=r"^picture .*\.png must be stored in .*missing"):
            painter.finish()


def test_a_process_that_died_leaves_the_pictures_to_this_one(results, tmp_path):
    with Painter() as painter:
        painter._process.kill()
        painter._process.wait()
        painter.begin(results, tmp_path, solid=False)
        assert painter.finish() is None
    assert not pictures(tmp_path)


def test_the_process_ends_with_the_block():
    with Painter() as painter:
        process = painter._process
    assert process.poll() is not None


@pytest.mark.parametrize(
    ("changes", "cores", "wanted"),
    [([], 2, True), ([], 1, False), (["output.pictures=false"], 2, False), (["numerics.threads=1"], 2, False)],
)
def test_it_is_started_where_there_are_pictures_and_a_core_for_them(monkeypatch, changes, cores, wanted):
    monkeypatch.setattr(module, "available_threads", lambda: cores)
    scene = load_scene("hertz", changes)
    with painter_of(scene.numerics.threads, pictures=scene.output.pictures) as painter:
        assert (painter is not None) is wanted
