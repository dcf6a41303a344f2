"""Bundled scenes with coatings against case CO, a Hankel and Fredholm solution; here on coarser cells."""

import numpy as np
import pytest

import eigencontact as ec
from close import close
from eigencontact.execution.run.driver import drive
from eigencontact.scene.loader import bundled_names

#: Thickness of the coating, which is the contact radius on the bare substrate; radius of the ball [m].
H, RADIUS = 2e-6, 20e-6
#: Peak pressure [Pa] and approach [m] on the bare substrate (Hertz).
P0, DELTA0 = 2 * 210e9 / (1 - 0.3**2) * H / (np.pi * RADIUS), H**2 / RADIUS
COARSER = ["grid.cells-per-contact-radius=20", "grid.margin=1.25", "output.pictures=false", "output.vtk=false"]
#: Depths of the maxima and some more, over the thickness.
DEPTHS = (0.01, 0.37, 0.43, 0.5, 0.6, 1.0, 1.03, 1.1, 1.3)
#: Peak pressure, radius, approach; von Mises stress, its depth over H, and its largest value in the substrate; sigma_xx
#: at the interface in the coating and in the substrate. All over those of the bare substrate.
CO = {
    "coated-sphere": (1.4754, 0.8185, 0.8269, 0.854, 0.43, 0.506, 0.229, 0.008),
    "soft-coating": (0.7047, 1.2066, 1.2271, 0.458, 0.50, 0.385, -0.132, -0.069),
}
#: Friction: largest von Mises stress, place (x, z) over contact radius and thickness; largest in the substrate.
SLIDING = {0.25: (0.916, 0.48, 0.38, 0.511), 0.5: (1.273, -0.73, 0.01, 0.526)}


@pytest.fixture
def finished(finished):
    """Run a bundled scene, its section at few depths."""

    def run(name, *changes):
        table = ec.load_scene(name, [*COARSER, *changes]).resolved()
        section = table["stress"][0]
        del section["depth-max"]
        section["depths"] = [share * H for share in DEPTHS]
        return finished(ec.Scene(**table))

    return run


def section(result):
    """Von Mises stress over P0, ``(nz, nx)``; x over the contact radius, z over the thickness."""
    data = result.dataset
    x, z = data.section_x.values / result.summary["contact_radius"], data.section_z.values / H
    return data.section_von_mises.values[-1] / P0, x, z


def at_centre(data, name):
    """Stress of a plane region in the cell nearest to the axis [Pa]."""
    return data[f"{name}_stress"].isel(step=-1).sel({f"{name}_{axis}": 0.0 for axis in "xy"}, method="nearest")


def test_every_bundled_coating_is_tested():
    """Fretting over a coating is in test_gallery_coated_fretting.py, wear in test_gallery_wear.py."""
    scenes = {name: ec.load_scene(name) for name in bundled_names()}
    layered = [name for name, scene in scenes.items() if scene.body1.medium is not None and scene.wear is None]
    layered = [name for name in layered if not scenes[name].grid.line]
    assert layered == sorted([*CO, "coated-fretting", "coated-sliding"])


@pytest.mark.parametrize("name", CO)
def test_coatings(name, finished):
    """CO-1 and CO-6."""
    result = finished(name)
    peak, radius, approach, mises, depth, below, above_jump, under_jump = CO[name]
    summary, data = result.summary, result.dataset
    assert summary["converged"] is True
    assert summary["max_pressure"] / P0 == close(peak, rel=0.005)
    assert summary["contact_radius"] / H == close(radius, rel=0.005)
    assert summary["approach"] / DELTA0 == close(approach, rel=0.002)
    field, _, z = section(result)
    assert field.max() == close(mises, abs=0.004)
    assert z[np.unravel_index(field.argmax(), field.shape)[0]] == close(depth, abs=0.08)
    assert field[z >= 1.0].max() == close(below, abs=0.004)
    stress = [at_centre(data, f"interface_{side}") / P0 for side in ("coating", "substrate")]
    assert [float(one.sel(component="xx")) for one in stress] == close([above_jump, under_jump], abs=0.003)
    zz = [float(one.sel(component="zz")) for one in stress]
    assert zz[0] == close(zz[1], rel=1e-6)


@pytest.mark.parametrize("friction", [pytest.param(0.25, marks=pytest.mark.slow), 0.5])
def test_sliding_over_a_coating(friction, finished):
    """CO-5: with a friction of 0.5 the von Mises stress is largest at the surface, with 0.25 inside the coating."""
    result = finished("coated-sliding", f"friction.coefficient={friction}", "stress.1.position=0")
    mises, place, depth, below = SLIDING[friction]
    summary = result.summary
    assert summary["slip_fraction"] == 1.0
    assert summary["tangential_load"] == close(friction * summary["normal_load"], rel=1e-6)
    assert summary["max_pressure"] / P0 == close(CO["coated-sphere"][0], rel=0.005)
    field, x, z = section(result)
    row = np.unravel_index(field.argmax(), field.shape)[0]
    assert field.max() == close(mises, rel=0.01)
    assert z[row] == close(depth, abs=0.03)
    # the maximum is flat along x: to 0.2 % from -0.9 to -0.5 with a friction of 0.5
    assert field[row, np.argmin(np.abs(x - place))] == close(mises, rel=0.01)
    assert field[z >= 1.0].max() == close(below, abs=0.004)


def test_the_profile_of_the_bare_substrate_stands_beside(finished):
    """Hertz's pressure on the substrate, under its own name: nobody takes it for a closed form of the coated body."""
    data = finished("soft-coating").dataset
    assert "reference_pressure" not in data
    assert "contact_modulus" not in data.attrs
    assert float(data.homogeneous_pressure.max()) == close(P0, rel=0.002)
    total = float(data.homogeneous_pressure.sum()) * float(np.prod(data.attrs["cell_size"]))
    assert total == close(float(data.normal_load[-1]), rel=0.002)


#: (E1/E2, thickness over the root of the bare contact area): peak pressure and area over those of the bare substrate.
THICKNESS = {
    (0.5, 0.05): (0.957, 1.099),
    (0.5, 0.2): (0.855, 1.261),
    (0.5, 0.5): (0.721, 1.434),
    (0.5, 1.5): (0.638, 1.568),
    (0.5, 1e4): (0.5 ** (2 / 3), 0.5 ** (-2 / 3)),
    (2.0, 1e4): (2.0 ** (2 / 3), 2.0 ** (-2 / 3)),
}


@pytest.mark.parametrize(("ratio", "thickness"), THICKNESS)
def test_from_thin_to_thick(ratio, thickness):
    """PL-2, and PL-1 where the coating is all that is felt."""
    peak, area = THICKNESS[ratio, thickness]
    table = ec.load_scene("soft-coating", [*COARSER, "stress=[]"]).resolved()
    layer = table["body1"]["medium"]["layers"][0]
    layer |= {"thickness": thickness * np.sqrt(np.pi) * H, "young-modulus": ratio * 210e9}
    (step,) = drive(ec.plan(ec.Scene(**table)))
    assert step.scalars["max_pressure"] / P0 == close(peak, rel=0.005)
    assert step.scalars["contact_area"] / (np.pi * H**2) == close(area, rel=0.01)
