import json

import numpy as np
import pytest

from close import close
from eigencontact.errors import ResultsError
from eigencontact.results.store import ResultStore
from eigencontact.results.summary import summary_of, write_summary
from results import synthetic

KEYS = """converged normal_load approach contact_area contact_radius max_pressure max_von_mises max_von_mises_depth
iterations convolutions solve_seconds peak_memory_bytes gap_residual name title scene_hash steps versions references
files history"""


@pytest.mark.parametrize("finished", [False, True])
@pytest.mark.parametrize("regions", [(), ("plane",)])
def test_summary_has_its_keys_and_the_history(tmp_path, finished, regions):
    info = synthetic.info(steps=3)
    store = ResultStore.create(tmp_path, info)
    records = [synthetic.step(info, n, n * 0.2, regions, observed=True) for n in (1, 2, 3)]
    for record in records:
        store.write_step(record)
    if finished:
        store.finish()
    history = store.history(records[-1])
    summary = summary_of(info, records[-1], history, {"peak_memory_bytes": np.int64(7)})
    found = json.loads(write_summary(tmp_path, summary).read_text())
    assert found == summary
    assert set(found) >= set(KEYS.split())
    assert found["converged"] is True
    assert found["normal_load"] == records[-1].scalars["normal_load"]
    assert found["iterations"] == 13 + 14 + 15
    assert isinstance(found["iterations"], int)
    assert found["solve_seconds"] == close(0.75, rel=1e-12)
    assert (found["max_von_mises"] is None) == (not regions)
    assert found["peak_memory_bytes"] == 7
    assert [row["step"] for row in found["history"]] == [1, 2, 3]
    assert [row["approach"] for row in found["history"]] == [record.scalars["approach"] for record in records]
    assert found["observed"] == {"probe_pressure": 3.0}


def test_not_a_number_is_null(tmp_path):
    info = synthetic.info()
    record = synthetic.step(info)
    record.scalars.update({"approach": np.nan, "iterations": np.inf, "gap_residual": np.float64(np.nan)})
    extra = {"timings": {"setup": np.nan, "list": (1, np.nan)}, "folder": tmp_path}
    text = write_summary(tmp_path, summary_of(info, record, [], extra)).read_text()
    assert "NaN" not in text
    assert "Infinity" not in text
    found = json.loads(text)
    assert (found["approach"], found["iterations"], found["gap_residual"]) == (None, None, None)
    assert found["timings"] == {"setup": None, "list": [1, None]}


def test_summary_that_cannot_be_stored(tmp_path):
    with pytest.raises(ResultsError, match=r"^the summary must be stored in"):
        write_summary(tmp_path / "nowhere", {})
