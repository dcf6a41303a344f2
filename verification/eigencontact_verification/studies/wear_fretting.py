"""Studies of a sphere moved to and fro on a coated body that wears: in partial slip, in gross slip, and its loops."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

from eigencontact.viz.style import new_figure
from eigencontact.viz.worn import SolvedCycle, solved_cycles
from eigencontact_verification.studies.common import colour
from eigencontact_verification.studies.plastic import BIG
from eigencontact_verification.studies.study import Finished, Row, SceneOf, Study, Variant, every, having, levels
from eigencontact_verification.studies.wear import (
    COATINGS,
    SECTION,
    draw_course,
    draw_profile,
    draw_sections,
    label,
    legend_below,
    numbers,
    scene_of,
)

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from eigencontact.scene.schema import Scene

__all__ = ["STUDIES"]

#: Load that friction carries [N].
_CARRIED = 0.5 * BIG.load
#: Scene by amplitude over contact radius.
_SCENES = {0.025: "fretting-wear-partial-slip", 0.125: "fretting-wear-gross-slip"}
#: The coating stays as thick as it is. Where it wears, the contact differs by 1 % at a depth of 2.6 µm.
_SPHERE_WEARS = "wear.body=2"


def _increments(quarter: int) -> list[str]:
    halves = [f"steps.2.cycle.{n}.increments={2 * quarter}" for n in (0, 1)]
    return [f"steps.1.increments={quarter}", *halves]


def _of_amplitude(amplitude: float) -> SceneOf:
    def scene(values: Mapping[str, float], *, coarse: bool) -> Scene:
        changes = ["grid.cells=25", "steps.2.repeat=4", *_increments(2)] if coarse else []
        return scene_of(_SCENES[amplitude], values, [*changes, _SPHERE_WEARS], stress=[SECTION])

    return scene


def _of_loops(values: Mapping[str, float], *, coarse: bool) -> Scene:
    """Thirty cycles; in gross slip to a depth of some 6 µm."""
    changes = ["grid.cells=25", "steps.2.repeat=4", *_increments(2)] if coarse else ["steps.2.repeat=30"]
    if values["δ/a"] > 0.1 and not coarse:
        changes += ['grid.size=["136 um", "136 um"]', "grid.cells=69"]
    return scene_of(_SCENES[values["δ/a"]], values, [*changes, _SPHERE_WEARS])


def _work(dataset: xr.Dataset, cycle: SolvedCycle) -> float:
    """Work of friction of a solved cycle [J]."""
    energy = dataset["dissipated_energy"].values
    return float(energy[cycle.last] - energy[cycle.first - 1])


def _read(_variant: Variant, dataset: xr.Dataset) -> Row:
    cycles = solved_cycles(dataset)
    load, worn = dataset["tangential_load_x"].values / _CARRIED, dataset["worn_depth"].isel(step=-1)
    row = int(np.abs(dataset["y"].values).argmin())
    middle = float(worn[row, int(np.abs(dataset["x"].values).argmin())])
    return {
        **numbers(dataset),
        "first W [uJ]": 1e6 * _work(dataset, cycles[0]),
        "W [uJ]": 1e6 * _work(dataset, cycles[-1]),
        "Q/μP": float(load[cycles[-1].first : cycles[-1].last + 1].max()),
        "middle / largest": middle / float(worn.max()),
    }


def _draw_loop(axes: Axes, data: xr.Dataset, cycle: SolvedCycle, tint: object, dash: str = "-") -> None:
    part = slice(cycle.first - 1, cycle.last + 1)
    load = data["tangential_load_x"].values[part] / _CARRIED
    axes.plot(data["shift_x"].values[part] / BIG.radius, load, dash, color=tint, linewidth=1.0)
    axes.set(xlabel=r"$\delta_x/a_0$")


def _draw(found: Sequence[Finished]) -> Figure:
    figure = new_figure(11.2, 7.6)
    panels = figure.subplots(3, 4)
    for axes, what in zip(panels[0], ("volume", "depth", "pressure", "area"), strict=True):
        draw_course(axes, found, what)
    worn, loops, pressed, sheared = panels[1]
    for n, item in enumerate(found):
        cycles = solved_cycles(item.dataset)
        for cycle, dash in ((cycles[0], ":"), (cycles[-1], "-")):
            _draw_loop(loops, item.dataset, cycle, colour(n), dash)
        draw_profile(worn, item, -1, "worn_depth", 1e6, n)
        draw_profile(pressed, item, -1, "pressure", 1.0 / BIG.peak, n)
        draw_profile(sheared, item, -1, "shear_x", 1.0 / BIG.peak, n)
    worn.set(title="worn depth [µm] in the end")
    worn.invert_yaxis()
    loops.set(title=r"$Q_x/\mu P$: first cycle dotted, last")
    pressed.set(title="pressure $/p_0$ in the end")
    sheared.set(title="shear $q_x/p_0$ in the end")
    sections, labels = list(panels[2, : len(found)]), [item.variant.label for item in found]
    draw_sections(sections, [item.dataset for item in found], labels, beside=panels[2, len(found)])
    for axes in panels[2, len(found) + 1 :]:
        axes.set_axis_off()
    legend_below(panels[0, 0])
    return figure


def _draw_loops(found: Sequence[Finished]) -> Figure:
    from matplotlib import colormaps

    amplitudes, ratios = levels(found, "δ/a", falling=True), levels(found, "E₁/E₂")
    figure = new_figure(3.0 * len(ratios) + 3.2, 5.6)
    panels = figure.subplots(2, len(ratios) + 1, squeeze=False)
    colours = colormaps["viridis"]
    for item in found:
        axes = panels[amplitudes.index(item["δ/a"]), ratios.index(item["E₁/E₂"])]
        cycles = solved_cycles(item.dataset)
        for cycle in cycles:
            _draw_loop(axes, item.dataset, cycle, colours(cycle.done / cycles[-1].done))
        axes.set(title=f"$Q_x/\\mu P$,\n{item.variant.label}", ylim=(-1.1, 1.1))
    (small, *_) = having(having(found, "δ/a", 0.025), "E₁/E₂", ratios[len(ratios) // 2])
    data = small.dataset
    cycles = solved_cycles(data)
    tenth = min(cycles, key=lambda cycle: abs(cycle.done - 10))
    for axes, cycle in zip(panels[:, -1], (cycles[0], tenth), strict=True):
        x, y = (data[axis].values / BIG.radius for axis in "xy")
        image = axes.pcolormesh(x, y, 1e9 * data["worn_depth"][cycle.last].values, cmap="viridis")
        axes.set(aspect="equal", title=f"depth [nm], {small.variant.label}\nafter {cycle.done:.0f}")
        figure.colorbar(image, ax=axes)
    figure.suptitle("Loops of all solved cycles, from the first (dark) to the last (bright)", fontsize=9.5)
    return figure


STUDIES = (
    Study(
        name="wear-fretting-partial-slip",
        title="Wear of coatings in partial slip: courses, profiles, loops and stresses over 15 cycles",
        repeats="thesis figures 4.41 to 4.45 (case WR-5)",
        scene=_of_amplitude(0.025),
        label=label,
        rows=every({"E₁/E₂": COATINGS}),
        coarse=every({"E₁/E₂": (0.5, 2.0)}),
        read=_read,
        draw=_draw,
        remark="A ring is worn, deeper the stiffer the coating; the loop turns clockwise and narrows; the pressure has "
        "a ring at the edge of what sticks, whose height follows the cells and has no limit. The depth is bounded: "
        "217 nm without a coating, however long the motion goes on. The text's microns cannot be right at this "
        "amplitude. Its coefficient of 1e4 mm³/(J mm) takes the slip of single increments, if read as printed, and "
        "its wear then depends on their number; with the slip of the cycle, as here, the first cycle would wear more "
        "than the limit. The coefficient here is 200 mm³/(J mm).",
    ),
    Study(
        name="wear-fretting-gross-slip",
        title="Wear of coatings in gross slip: courses, profiles, loops and stresses over 15 cycles",
        repeats="thesis figures 4.46 to 4.50 (case WR-6)",
        scene=_of_amplitude(0.125),
        label=label,
        rows=every({"E₁/E₂": COATINGS}),
        coarse=every({"E₁/E₂": (0.5, 2.0)}),
        read=_read,
        draw=_draw,
        remark="Wear is deepest in the middle where the contact slides as a whole; pressures fall and come together. "
        "The text's loops close and its work of friction falls: under a load that is kept, as the text keeps it, "
        "they cannot. Sliding carries μP in every cycle, and a larger contact is stiffer along the surface, so that "
        "the loop opens and its work rises towards 4 μ P δ. With the approach kept they close: see the scene "
        "fretting-loop-evolution.",
    ),
    Study(
        name="wear-fretting-loops",
        title="Loops of thirty cycles of fretting wear, coatings and both amplitudes; depth after cycle 1 and 10",
        repeats="thesis figures 4.51 to 4.53",
        scene=_of_loops,
        label="E₁/E₂ = {E₁/E₂:g}, δ/a = {δ/a:g}".format_map,
        rows=every({"δ/a": (0.125, 0.025), "E₁/E₂": COATINGS}),
        coarse=every({"δ/a": (0.125, 0.025), "E₁/E₂": (1.0,)}),
        read=_read,
        draw=_draw_loops,
        remark="The text closes the wide loops: under a kept load they open (see wear-fretting-gross-slip). The narrow "
        "ones turn clockwise and narrow, most in the first cycles, as in the text; their depth stays below its limit "
        "of 217 nm (no coating), not 6 µm. Depth differs along x and y by the slip that Poisson's ratio gives.",
    ),
)
