"""Pictures of friction: what is drawn when, what each shows, that nothing overlaps or is cut."""

from functools import cache
from pathlib import Path

import matplotlib as mpl
import numpy as np
import pytest
from PIL import Image

from close import close
from eigencontact.viz.figures import draw_all
from eigencontact.viz.friction import ZONE_COLOURS, dissipation_map, driven, shear_map, shear_profiles
from eigencontact.viz.friction_history import fretting_loops, zone_strip
from eigencontact.viz.style import scale_for
from eigencontact.viz.vtk import write_vtk
from eigencontact.viz.window import is_ragged
from results import synthetic
from viz.test_figures import overlaps

MU = 0.4
SHIFT = 200e-9  # that of the onset of sliding, of any size here


def hertz(x, y, load):
    a, p0, _ = synthetic.hertz(max(load, 1e-12))
    return p0 * np.sqrt(np.maximum(0, 1 - (x**2 + y**2) / a**2))


def record(info, index, load, reach, angle, peak=None, reference=False):
    """Cattaneo and Mindlin's traction at the part `reach` of the sliding load; coming back from `peak` where given."""
    step = synthetic.step(info, index, load, (), reference=False, error=0.0)
    y, x = info.grid.axes()
    pressure = hertz(x, y, load)

    def traction(part):
        return MU * (pressure - hertz(x, y, load * (1 - part)))

    if peak is None:
        size, shift, inner = traction(reach), 1 - (1 - reach) ** (2 / 3), 1 - reach
    else:
        turned = (peak - reach) / 2
        size = traction(peak) - 2 * traction(turned)
        shift, inner = 1 - (1 - peak) ** (2 / 3) - 2 * (1 - (1 - turned) ** (2 / 3)), 1 - turned
    loaded = pressure > 0
    stick = loaded & (hertz(x, y, load * inner) > 0)
    density = np.where(stick | ~loaded, 0.0, 1e-3 * index * (1 + x / 1e-5))
    along = np.cos(angle), np.sin(angle)
    zero = np.zeros(info.grid.shape)
    step.fields.update(
        pressure=pressure, shear_x=size * along[0], shear_y=size * along[1], slip_x=zero + 1e-9, slip_y=zero,
        displacement_x=zero, displacement_y=zero, slip_distance=zero, dissipated_energy_density=density,
        contact_zone=np.where(stick, 2.0, np.where(loaded, 1.0, 0.0)), shear_bound=MU * pressure,
    )  # fmt: skip
    if reference:
        step.fields.update(reference_shear_x=size * along[0], reference_shear_y=size * along[1])
    force, way = MU * load * reach, SHIFT * shift
    step.scalars.update(
        tangential_load_x=force * along[0], tangential_load_y=force * along[1], tangential_load=abs(force),
        shift_x=way * along[0], shift_y=way * along[1], shift=abs(way), torsion_moment=0.0, twist=0.0,
        dissipated_energy=float(density.sum()) * info.grid.cell_area,
    )  # fmt: skip
    return step


@pytest.fixture(scope="module")
def stored():
    """Make up the dataset of a history, once."""

    @cache
    def build(history, *, change=None, reference=False, n=24, ny=None):
        info = synthetic.info(nx=n, ny=ny or n, steps=len(history))
        records = [record(info, index, *point, reference=reference) for index, point in enumerate(history, 1)]
        for step in records if change is not None else ():
            change(step, info)
        return synthetic.opened(info, records)

    return build


LOAD = synthetic.LOAD
MONOTONIC = tuple((LOAD, reach, 0.0) for reach in (0.0, 0.2, 0.5))
BACK = np.linspace(0.8, -0.8, 5)[1:]
#: From rest to 0.8, back to -0.8 and again to 0.8: the second half mirrors the first.
CYCLE = (
    *((LOAD, reach, 0.0) for reach in (0.4, 0.8)),
    *((LOAD, reach, 0.0, 0.8) for reach in BACK),
    *((LOAD, reach, np.pi, 0.8) for reach in BACK),
)


def torsion(made, info):
    """Turn a made-up step into one of torsion."""
    y, x = info.grid.axes()
    size, r = made.fields["shear_x"], np.hypot(x, y) + 1e-12
    made.fields["shear_x"], made.fields["shear_y"] = -size * y / r, size * x / r
    scalars = made.scalars
    scalars["torsion_moment"], scalars["twist"] = 1e-6 * scalars["tangential_load_x"], 1e6 * scalars["shift_x"]
    for name in ("tangential_load_x", "tangential_load", "shift_x", "shift_magnitude"):
        scalars[name] = 0.0


def radial(made, info):
    """Shear that points away from the axis, as by pressing; no tangential load."""
    torsion(made, info)
    q_x, q_y = made.fields["shear_x"], made.fields["shear_y"]
    made.fields["shear_x"], made.fields["shear_y"] = q_y, -q_x
    made.scalars["torsion_moment"] = made.scalars["twist"] = 0.0


def rough(made, info):
    y, x = info.grid.axes()
    spots = np.sin(6e6 * x) * np.sin(7e6 * y) > 0.3
    for name in ("pressure", "shear_x", "shear_bound", "contact_zone", "dissipated_energy_density"):
        made.fields[name] = made.fields[name] * spots


def nothing(made, info):
    for name in ("pressure", "shear_x", "shear_bound", "contact_zone", "dissipated_energy_density"):
        made.fields[name] = 0.0 * made.fields[name]
    for name in ("tangential_load_x", "tangential_load", "shift_x", "shift_magnitude", "dissipated_energy"):
        made.scalars[name] = 0.0


def all_slip(made, info):
    """Let all of the contact slip from the second step on; in the first nothing moves, and all sticks."""
    if made.index > 1:
        made.fields["contact_zone"] = np.minimum(made.fields["contact_zone"], 1.0)


def along_y(made, info):
    torsion(made, info)
    made.fields["shear_y"] = made.fields["shear_x"]
    scalars = made.scalars
    scalars["tangential_load_y"], scalars["shift_y"] = 1e6 * scalars["torsion_moment"], 1e-6 * scalars["twist"]
    scalars["torsion_moment"] = scalars["twist"] = 0.0


def one_direction(made, info):
    """Leave out what a run with coupling "none" and no load along y leaves out."""
    for name in ("shear_y", "slip_y", "displacement_y"):
        del made.fields[name]


CASES = {
    "monotonic": {"history": MONOTONIC},
    "beside the closed form": {"history": MONOTONIC, "reference": True},
    "cycle": {"history": CYCLE},
    "torsion": {"history": CYCLE, "change": torsion},
    "radial": {"history": MONOTONIC, "change": radial},
    "rough": {"history": MONOTONIC, "change": rough, "n": 64},
    "one direction": {"history": MONOTONIC, "change": one_direction},
    "one row": {"history": MONOTONIC, "ny": 1},
    "no contact": {"history": MONOTONIC, "change": nothing},
}


DRAWN = {
    shear_map: ("monotonic", "torsion", "rough", "one row", "no contact"),
    shear_profiles: ("beside the closed form", "torsion", "rough", "one row", "no contact"),
    dissipation_map: ("cycle",),
    fretting_loops: ("cycle", "torsion"),
    zone_strip: ("cycle", "radial", "no contact"),
}


@pytest.mark.parametrize(
    ("draw", "case"),
    [pytest.param(draw, case, id=f"{draw.__name__}, {case}") for draw, cases in DRAWN.items() for case in cases],
)
def test_texts_do_not_overlap(stored, draw, case):
    assert overlaps(draw(stored(**CASES[case]))) == []


ALWAYS = ["pressure.png", "pressure-profiles.png", "shear.png", "shear-profiles.png"]


@pytest.mark.parametrize(
    ("case", "names"),
    [
        ({"history": CYCLE}, [*ALWAYS, "dissipation.png", "loop.png", "zones.png"]),
        ({"history": MONOTONIC}, [*ALWAYS, "dissipation.png", "zones.png"]),
        ({"history": MONOTONIC[:2]}, [*ALWAYS, "dissipation.png"]),
        ({"history": MONOTONIC[:1]}, ALWAYS[:2]),  # nothing is sheared
        ({"history": MONOTONIC, "change": radial}, [*ALWAYS, "dissipation.png"]),
        ({"history": MONOTONIC, "change": all_slip}, [*ALWAYS, "dissipation.png"]),
        ({"history": ((0.2, 0.0, 0.0), *MONOTONIC)}, [*ALWAYS, "dissipation.png", "zones.png", "history.png"]),
    ],
    ids=["cycle", "monotonic", "two steps", "no slip", "constant loads", "all slips", "the normal load changes"],
)
def test_which_pictures_a_run_gets(stored, monkeypatch, case, names):
    monkeypatch.setattr("eigencontact.viz.figures.save", lambda *_: None)
    assert list(draw_all(stored(**case), Path())) == names


@pytest.mark.slow
def test_all_are_written_and_nothing_is_cut_off(stored, tmp_path):
    before = dict(mpl.rcParams)
    described = draw_all(stored(**CASES["cycle"]), tmp_path)
    assert dict(mpl.rcParams) == before
    for name, sentence in described.items():
        assert sentence.endswith(".")
        with Image.open(tmp_path / name) as picture:
            pixels = np.asarray(picture.convert("L"), dtype=float)
        edge = np.concatenate([pixels[0], pixels[-1], pixels[:, 0], pixels[:, -1]])
        assert min(pixels.shape) > 300
        assert edge.min() > 250, f"something is cut off at the edge of {name}"


def test_the_map_shows_the_zones_and_equal_scales(stored):
    dataset = stored(**CASES["monotonic"])
    main = shear_map(dataset).axes[0]
    image = main.images[0]
    assert main.get_aspect() == 1.0
    assert (main.get_xlabel(), main.get_ylabel()) == ("x [µm]", "y [µm]")
    colours = [mpl.colors.to_hex(image.cmap(image.norm(value))) for value in (0, 1, 2)]
    assert colours == [colour.lower() for colour in ZONE_COLOURS]
    zone = dataset["contact_zone"][-1].values
    stick = np.count_nonzero(zone == 2) / np.count_nonzero(zone)
    words = [text.get_text() for text in shear_map(dataset).legends[0].get_texts()]
    assert words[:2] == [f"stick, {100 * stick:.3g} %", f"slip, {100 * (1 - stick):.3g} %"]
    assert words[2].startswith("longest arrow: ")


def test_a_zone_that_is_nowhere_is_not_in_the_legend(stored):
    def slide(made, info):
        made.fields["contact_zone"] = np.minimum(made.fields["contact_zone"], 1.0)

    words = [text.get_text() for text in shear_map(stored(MONOTONIC, change=slide)).legends[0].get_texts()]
    assert words[0] == "slip everywhere"
    assert not any(word.startswith("stick") for word in words)


@pytest.mark.parametrize("n", [24, 25, 64])
def test_arrows_are_those_of_their_cells_and_lie_evenly(stored, n):
    dataset = stored(MONOTONIC, n=n, change=torsion)
    quiver = next(item for item in shear_map(dataset).axes[0].collections if isinstance(item, mpl.quiver.Quiver))
    places, arrows = 1e-6 * np.asarray(quiver.XY), np.stack([quiver.U, quiver.V], axis=-1)
    assert 50 < len(places) < 500
    cell = 16e-6 / n
    column, row = np.rint((places + 8e-6) / cell - 0.5).astype(int).T
    np.testing.assert_allclose(places, np.stack([dataset["x"][column], dataset["y"][row]], axis=-1), atol=1e-15)
    shear = np.stack([dataset[f"shear_{axis}"][-1].values[row, column] for axis in "xy"], axis=-1)
    np.testing.assert_allclose(arrows / np.abs(arrows).max(), shear / np.abs(shear).max(), atol=1e-9)
    assert np.abs(places.mean(axis=0)).max() <= 0.51 * cell
    longest = np.hypot(*arrows.T).max() * 1e-6
    spacing = np.diff(np.unique(np.round(places[:, 0], 12))).min()
    assert 0.8 * spacing < longest < spacing


def test_a_ragged_contact_has_arrows_on_its_patches_and_no_outline(stored):
    dataset = stored(**CASES["rough"])
    zone = dataset["contact_zone"][-1].values > 0
    assert is_ragged(zone)
    main = shear_map(dataset).axes[0]
    quiver = next(item for item in main.collections if isinstance(item, mpl.quiver.Quiver))
    at = np.rint((1e-6 * np.asarray(quiver.XY) + 8e-6) / 0.25e-6 - 0.5).astype(int)
    assert len(at) > 20
    assert zone[at[:, 1], at[:, 0]].all()
    assert not any(isinstance(item, mpl.collections.LineCollection) for item in main.collections)


def lines(axes):
    return {line.get_label(): line for line in axes.get_lines() if not line.get_label().startswith("_")}


def test_profiles_show_the_shear_its_bound_and_the_closed_form(stored):
    dataset = stored(**CASES["beside the closed form"])
    figure = shear_profiles(dataset)
    drawn = lines(figure.axes[0])
    assert sorted(drawn) == ["$q_x$", "$q_x$, closed form (0 % in the L2 norm)", "friction bound"]
    assert drawn["$q_x$, closed form (0 % in the L2 norm)"].get_linestyle() == "--"
    for label, name in (("$q_x$", "shear_x"), ("friction bound", "shear_bound")):
        x, y = drawn[label].get_data()
        expected = dataset[name][-1, 12].sel(x=1e-6 * x, method="nearest").values
        np.testing.assert_allclose(y * 1e9, expected, rtol=1e-12)
    assert figure.axes[0].get_ylabel() == "Shear traction [GPa]"
    assert figure.get_suptitle() == "Shear traction at P = 651 mN, Q = 130 mN"
    stripe = next(patch for patch in figure.axes[0].patches if patch.get_label() == "stick")
    stick = dataset["x"].values[dataset["contact_zone"][-1, 12].values == 2]
    half = 0.5 * float(dataset.attrs["cell_size"][0])
    expected = [1e6 * (stick[0] - half), 1e6 * (stick[-1] + half)]
    assert [stripe.get_x(), stripe.get_x() + stripe.get_width()] == close(expected, rel=1e-9)


def test_profiles_of_torsion_cross_and_both_bounds_are_drawn(stored):
    figure = shear_profiles(stored(**CASES["torsion"], n=25))
    left, right = (lines(axes) for axes in figure.axes)
    assert "$q_y$" in left
    assert "$q_x$" not in left
    assert "$q_x$" in right
    assert "$q_y$" not in right
    bounds = [line for line in figure.axes[0].get_lines() if line.get_color() == "0.75"]
    assert len(bounds) == 2
    np.testing.assert_array_equal(bounds[0].get_ydata(), -bounds[1].get_ydata())


def test_a_closed_form_that_does_not_hold_is_left_out(stored):
    def spoil(made, info):
        if made.index == 3:
            del made.fields["reference_shear_x"], made.fields["reference_shear_y"]

    dataset = stored(MONOTONIC, reference=True, change=spoil)
    assert not [label for label in lines(shear_profiles(dataset).axes[0]) if "closed form" in label]
    assert [label for label in lines(shear_profiles(dataset, 1).axes[0]) if "closed form" in label]


def test_the_loop_is_that_of_the_scalars_and_its_last_cycle_is_tinted(stored):
    dataset = stored(**CASES["cycle"])
    figure = fretting_loops(dataset)
    main = figure.axes[0]
    assert len(figure.axes) == 1
    assert (main.get_xlabel(), main.get_ylabel()) == (r"Shift $\delta_x$ [nm]", "Tangential load $Q_x$ [mN]")
    loop = next(line for line in main.get_lines() if len(line.get_xdata()) == len(CYCLE))
    np.testing.assert_allclose(1e-9 * loop.get_xdata(), dataset["shift_x"].values, rtol=1e-12, atol=1e-18)
    np.testing.assert_allclose(1e-3 * loop.get_ydata(), dataset["tangential_load_x"].values, rtol=1e-12, atol=1e-15)
    corners = main.patches[0].get_xy()
    np.testing.assert_allclose(1e-9 * corners[:9, 0], dataset["shift_x"].values[1:], rtol=1e-12, atol=1e-18)
    work = float(dataset["dissipated_energy"][-1] - dataset["dissipated_energy"][1])
    heading, ratio = figure.get_suptitle().split("\n")
    assert heading == f"Cycle of steps 2 to 10: work of friction {scale_for([work], 'J').text(work)}"
    assert ratio.startswith("energy ratio ")


@pytest.mark.parametrize(("share", "plastic", "said"), [(1.0, 0.0, False), (1.05, 0.0, True), (0.95, 0.05, False)])
def test_a_loop_of_coarse_increments_has_the_work_of_the_run_and_says_that_its_area_is_another(
    stored, share, plastic, said
):
    def spend(made, info):
        """Gross slip of a square loop: the corners of the polygon are those of the loop, or cut off."""
        way, force = ((0, 0), (1, 1), (1, -1), (-1, -1), (-1, 1), (1, 1))[made.index - 1]
        made.scalars.update(
            shift_x=1e-6 * way, tangential_load_x=0.1 * force, dissipated_energy=share * 1e-7 * max(0, made.index - 2)
        )
        made.scalars.update({"plastic_work": plastic * 1e-7 * made.index} if plastic else {})

    title = fretting_loops(stored(6 * ((LOAD, 0.1, 0.0),), change=spend)).get_suptitle()
    energy = share * 400
    assert title.startswith(f"Cycle of steps 2 to 6: work of friction {energy:.3g} nJ\nenergy ratio")
    assert title.split(" = ")[1].startswith(f"{share:.3g}")
    assert title.endswith(", increments too coarse for the area of the drawn loop") == said


def test_the_loop_of_torsion(stored):
    main = fretting_loops(stored(**CASES["torsion"])).axes[0]
    assert main.get_xlabel().startswith(r"Twist $\varphi_z$ [")
    assert main.get_ylabel().startswith("Torsion moment $M_z$ [")


def test_an_open_path_has_the_work_so_far(stored):
    dataset = stored(**CASES["monotonic"])
    assert fretting_loops(dataset).get_suptitle().endswith(", no closed cycle")
    assert not fretting_loops(dataset).axes[0].patches


@pytest.mark.parametrize(
    ("case", "modes"),
    [("cycle", ["x"]), ("torsion", ["twist"]), ("radial", []), ("no contact", []), ("one direction", ["x"])],
)
def test_what_is_driven(stored, case, modes):
    assert driven(stored(**CASES[case])) == modes


@pytest.mark.parametrize(("change", "along"), [(None, "x"), (along_y, "y")])
def test_the_strip_shows_the_zones_of_one_line_over_the_steps(stored, change, along):
    dataset = stored(CYCLE, change=change)
    figure = zone_strip(dataset)
    below = figure.axes[1]
    assert (below.get_xlabel(), below.get_ylabel()) == ("Step", f"{along} [µm]")
    shown = below.collections[0].get_array().reshape(-1, len(CYCLE))
    line = dataset["contact_zone"].isel({"y" if along == "x" else "x": 12}).values.T
    first = (line.shape[0] - shown.shape[0]) // 2
    np.testing.assert_array_equal(shown, line[first : first + len(shown)])
    assert not line[:first].any()
    assert len(figure.axes[0].get_lines()) == 2  # tangential load and zero; the constant normal load is left out


def test_the_strip_shows_the_course_of_bulk_stress(stored):
    def stretched(step, info):
        step.scalars["bulk_stress_xx"] = 1e8 * (step.index - 1)
        step.scalars["body2_bulk_stress_xy"] = 5e7  # constant: left out

    above = zone_strip(stored(CYCLE, change=stretched)).axes[0]
    curve = above.get_lines()[1]
    assert curve.get_label().startswith(r"$\sigma_{xx}$ (largest ")
    np.testing.assert_allclose(curve.get_ydata(), np.linspace(0.0, 1.0, len(CYCLE)), rtol=1e-12)
    assert len(above.get_lines()) == 3


def test_the_dissipation_is_masked_where_nothing_slipped(stored):
    dataset = stored(**CASES["monotonic"])
    figure = dissipation_map(dataset)
    image = figure.axes[0].images[0].get_array()
    density = dataset["dissipated_energy_density"][-1].values
    assert image.count() == np.count_nonzero(density)
    assert float(image.max()) * 1e-3 == close(density.max(), rel=1e-12)
    assert figure.axes[1].get_ylabel() == "Dissipated energy [mJ/m²]"
    assert "no slip" in [text.get_text() for text in dissipation_map(dataset, 0).axes[0].texts]


def test_vtk_has_the_vectors_of_friction(stored, tmp_path):
    import pyvista as pv

    for case in ("cycle", "one direction"):
        dataset = stored(**CASES[case])
        write_vtk(dataset.isel(step=slice(0, 3)), tmp_path / case)
        mesh = pv.read(tmp_path / case / "surface_0003.vti")
        assert {"contact_zone", "slip_distance", "dissipated_energy_density", "shear_bound"} <= set(
            mesh.cell_data.keys()
        )
        shear = np.asarray(mesh.cell_data["shear"])
        np.testing.assert_array_equal(shear[:, 0], dataset["shear_x"][2].values.ravel())
        np.testing.assert_array_equal(shear[:, 2], 0.0)
        np.testing.assert_array_equal(np.asarray(mesh.cell_data["slip"])[:, 0], 1e-9)
        np.testing.assert_array_equal(
            np.asarray(mesh.cell_data["displacement"])[:, 2], dataset["displacement_z"][2].values.ravel()
        )
