"""What pictures read of results, against what xarray reads: xarray is the judge."""

import numpy as np
import pytest

from eigencontact.errors import ResultsError
from eigencontact.results.reader import open_results
from eigencontact.results.store import ResultStore
from eigencontact.results.stored import open_stored
from eigencontact.viz.figures import draw_all
from eigencontact.viz.vtk import write_vtk
from results import synthetic


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    place = tmp_path_factory.mktemp("stored")
    info = synthetic.info(nx=8, ny=6, steps=3)
    store = ResultStore.create(place, info)
    for n in (1, 2, 3):
        store.write_step(synthetic.step(info, n, n * 0.2, ("plane", "line", "points")))
    store.finish()
    return place


def test_everything_is_as_xarray_reads_it(folder):
    with open_results(folder) as judge, open_stored(folder) as found:
        assert list(found.data_vars) == list(judge.data_vars) == list(found)
        assert set(found.variables) == set(judge.variables)
        assert found.sizes == dict(judge.sizes)
        assert found.attrs.keys() == judge.attrs.keys()
        for name, value in judge.attrs.items():
            np.testing.assert_array_equal(found.attrs[name], value)
        for name, variable in judge.variables.items():
            read = found[name]
            assert (read.dims, read.shape, read.ndim) == (variable.dims, variable.shape, variable.ndim), name
            assert read.attrs == {key: value for key, value in variable.attrs.items() if key[:1] != "_"}, name
            np.testing.assert_array_equal(read.values, variable.values)
            for index in (-1, 1) if variable.ndim and variable.shape[0] > 1 else ():
                np.testing.assert_array_equal(read[index].values, variable[index].values)
        assert "pressure" in found
        assert "pressures" not in found
        assert float(found["normal_load"][-1]) == float(judge["normal_load"][-1]) > 0


@pytest.mark.slow
def test_pictures_and_vtk_files_are_the_same(folder, tmp_path):
    written = []
    for place, opened in ((tmp_path / "judge", open_results), (tmp_path / "found", open_stored)):
        place.mkdir()
        with opened(folder) as dataset:
            draw_all(dataset, place)
            write_vtk(dataset, place)
        written.append({path.name: path.read_bytes() for path in place.iterdir()})
    assert len(written[0]) > 10
    assert written[0] == written[1]


def test_a_file_that_is_no_results_is_refused_in_the_same_words(tmp_path):
    path = tmp_path / "results.nc"
    path.write_bytes(b"\x89HDF\r\n\x1a\n" + bytes(64))
    for opened in (open_results, open_stored):
        with pytest.raises(ResultsError, match=r"must be a complete results file .*; run the scene again with --over"):
            opened(path)
