"""Profiles of the surface above a buried cube: the pictures, and what they are there to show."""

import numpy as np
import pytest

from close import close
from eigencontact_verification import profiles


@pytest.mark.slow
def test_pictures(tmp_path):
    from matplotlib.image import imread

    deviations = profiles.write_pictures(tmp_path / "new", lines=7, marks=7, depths=4)
    assert set(deviations) == {"surface-profiles-trace-free", "surface-profiles-components"}
    assert max(deviations.values()) <= 2e-12
    names = [*deviations, "cube-against-sphere"]
    assert sorted(path.stem for path in (tmp_path / "new").iterdir()) == sorted(names)
    for name in names:
        pixels = imread(tmp_path / "new" / f"{name}.png")
        assert min(pixels.shape[:2]) > 500
        assert pixels.std() > 0.05


@pytest.mark.slow
def test_command_line(tmp_path, capsys):
    assert profiles.main(["-o", str(tmp_path)]) == 0
    assert capsys.readouterr().out.count(".png") == len(list(tmp_path.iterdir())) == 3


def test_equal_volume_sphere():
    """Its radius is 0.1241 of the depth of five edges."""
    assert close(0.1241, abs=5e-5) == profiles.RADIUS / profiles.DEPTH


def test_a_sphere_replaces_a_cube_at_depth():
    """Their second moments differ, so the difference falls with the square of depth; 0.14 % at five edges."""
    found = profiles.differences(profiles.COMPONENTS, np.array([5.0, 20.0, 40.0]), lines=31)
    assert found[:, 0].min() > 5e-4
    assert found[:, 0].max() == close(1.4e-3, rel=0.05)
    rate = np.log2(found[:, 1] / found[:, 2])
    np.testing.assert_allclose(rate, 2.0, atol=0.05)
