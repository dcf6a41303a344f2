"""`eigencontact verify RESULTS` with pictures of stored planes, and on a cluster with the same verdicts."""

from __future__ import annotations

import json

import numpy as np
import pytest

import eigencontact as ec
from eigencontact_verification.audit import cases_of, engines
from eigencontact_verification.audit.sections import draw_section

#: Unknowns of the fine mesh: enough to run, not to judge.
FEW = (30_000, 30_000)


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    folder = tmp_path_factory.mktemp("audited") / "run"
    scene = ec.load_scene("hertz", ["grid.cells-per-contact-radius=8", "output.pictures=false", "output.vtk=false"])
    ec.run(scene, folder).dataset.close()
    return folder


@pytest.fixture
def light(monkeypatch):
    monkeypatch.setattr(engines, "_BUDGETS", FEW)


@pytest.mark.slow
def test_a_section_has_what_is_stored_where_it_is_judged(run, light, tmp_path):
    (case,), _ = cases_of(run)
    (section,) = case.sections
    kept = np.isfinite(section.values).all(axis=-1)
    assert kept.any()
    assert not kept.all()  # what lies so near the surface that the cells are felt is not judged
    assert section.points[kept][:, 2].min() > 0.0
    file = draw_section(section, 1.05 * section.values, "words", tmp_path / "one.png")
    assert file.stat().st_size > 10_000


@pytest.mark.slow
def test_the_stress_of_a_picture_is_that_of_the_elements(run, light):
    (case,), _ = cases_of(run)
    (section,) = case.sections
    found = case._stress(section)
    kept = np.isfinite(section.values)
    assert np.array_equal(np.isfinite(found), kept)
    error = np.abs(found - section.values)[kept].max() / np.abs(section.values[kept]).max()
    assert 0.0 < error < 0.1  # of this coarse mesh


@pytest.mark.slow
def test_pictures_are_written_and_told(run, light, command, tmp_path):
    command("verify", str(run), "--quick", "--pictures", "--json", "-o", str(tmp_path / "out"))
    (picture,) = (tmp_path / "out" / "fields").rglob("*.png")
    told = picture.relative_to(tmp_path / "out").as_posix()
    assert told in (tmp_path / "out" / "report.md").read_text(encoding="utf-8")


@pytest.mark.slow
def test_workers_of_a_cluster_give_the_same_verdicts(run, light, command, tmp_path):
    pytest.importorskip("distributed")
    answers = [
        command("verify", str(run), "--quick", "--json", "-o", str(tmp_path / name), *options)
        for name, options in (("alone", ()), ("cluster", ("--cluster", "local:2")))
    ]
    alone, cluster = ([case["rows"] for case in json.loads(one.out)["cases"]] for one in answers)
    assert alone == cluster
    assert any(row["difference"] for rows in alone for row in rows)
    assert answers[0].code == answers[1].code


RING = '''
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from eigencontact.plugin import InclusionShape, Length, Place, hookimpl


@dataclass(frozen=True, kw_only=True)
class Ring(InclusionShape):
    """Ring about an axis along z.

    Parameters
    ----------
    center : (float, float, float)
        Middle [m].
    size : float
        Of the section; twice that is the radius [m].
    """

    key: ClassVar[str] = "ring-of-a-file"

    center: Place
    size: Length

    @property
    def bounds(self):
        reach = np.array([3.0, 3.0, 1.0]) * self.size
        return tuple(np.subtract(self.center, reach)), tuple(np.add(self.center, reach))

    def contains(self, x, y, z):
        x0, y0, z0 = self.center
        return (np.hypot(x - x0, y - y0) - 2.0 * self.size) ** 2 + (z - z0) ** 2 <= self.size**2


@hookimpl
def eigencontact_register():
    return [Ring]
'''


@pytest.mark.slow
def test_a_run_names_the_plugin_files_that_its_audit_needs(light, command, tmp_path, monkeypatch):
    home, elsewhere = tmp_path / "home", tmp_path / "elsewhere"
    home.mkdir()
    elsewhere.mkdir()
    (home / "ring.py").write_text(RING, encoding="utf-8")
    (home / "ring.toml").write_text(
        """
        title = "ring"
        plugins = ["ring.py"]
        body1 = { young-modulus = "210 GPa", poisson-ratio = 0.3 }
        inclusions = { type = "ring-of-a-file", center = [0, 0, "3 um"], size = "1 um", eigenstrain = 1e-3 }
        grid = { cells = 17, spacing = ["0.6 um", "0.6 um"] }
        output = { pictures = false }
        """,
        encoding="utf-8",
    )
    monkeypatch.chdir(elsewhere)
    assert command("run", str(home / "ring.toml"), "-q", "-o", "run").code == 0
    told = command("verify", "run", "--quick", "--json", "-o", "out")
    assert told.code == 0, told.err
    assert json.loads(told.out)["counts"]["failed"] == 0
