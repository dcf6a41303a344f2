"""Studies of a rigid sphere that slides over a coated body; the shear does not change the pressure."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cache, partial
from typing import TYPE_CHECKING, Any

import numpy as np

from eigencontact.viz.style import new_figure
from eigencontact_verification.studies.coatings import (
    COMPARED,
    below_the_middle,
    coated_body,
    coated_scene,
    draw_section,
    oracle,
    split,
)
from eigencontact_verification.studies.common import COATED, colour, cut_depths, legend_beside, von_mises
from eigencontact_verification.studies.study import Finished, Row, Study, Variant, every, having, levels

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from eigencontact.scene.schema import Scene

__all__ = ["STUDIES"]

_A = COATED.radius
#: Depths of the section [m]: the skin, where the stress is largest under friction, and the middles of layers.
_DEPTHS = [0.01 * _A, *cut_depths(_A / 16, 2.5 * _A)]
_COMPONENTS = {"xx": 0, "zz": 2, "xz": 4}
#: Depths of the markers of the independent solution, over the thickness.
_MARKERS = (0.1, 0.4, 0.7, 0.98, 1.02, 1.4, 2.0)


def _scene(values: Mapping[str, float], *, coarse: bool, axis: bool = False) -> Scene:
    """Sphere that slides, if there is friction; stress in a section or on the axis."""
    section = {"name": "section", "shape": "plane", "normal": "y", "depths": _DEPTHS}
    tables: dict[str, Any] = {"stress": [below_the_middle(coarse=coarse) if axis else section]}
    if values["μ"]:
        tables["friction"] = {"type": "coulomb", "coefficient": values["μ"]}
        tables["steps"] = [{"normal_load": COATED.load}, {"shift_x": _A}]
        tables["numerics"] = {"coupling": "partial"}
    return coated_scene(coated_body(values["E₁/E₂"]), cells=32 if coarse else 80, width=3.6, **tables)


_LABEL = "E₁/E₂ = {E₁/E₂:g}, μ = {μ:g}".format_map
_ROWS = every({"E₁/E₂": (0.5, 1.0, 2.0), "μ": (0.0, 0.25, 0.5)})


def _read_map(_variant: Variant, dataset: xr.Dataset) -> Row:
    section = von_mises(dataset, COATED)
    x, z = dataset["section_x"].values / _A, dataset["section_z"].values / _A
    row, column = np.unravel_index(int(section.argmax()), section.shape)
    return {
        "largest von Mises / p0": float(section.max()),
        "at x / h": float(x[column]),
        "at z / h": float(z[row]),
        "near the surface": float(section[0].max()),
        "in the substrate": float(section[z > 1.0].max()),
    }


def _read_axis(variant: Variant, dataset: xr.Dataset) -> Row:
    depth, stress = dataset["axis_z"].values / _A, _stress(dataset)
    above, below = int(np.flatnonzero(depth < 1.0)[-1]), int(np.flatnonzero(depth > 1.0)[0])
    errors = [
        abs(np.interp(z, depth, stress[n]) - known[n])
        for z in COMPARED
        for known in [_oracle_stress(variant, z)]
        for n in _COMPONENTS.values()
    ]
    return {
        "sigma_xx above the interface / p0": float(stress[0, above]),
        "sigma_xx below": float(stress[0, below]),
        "largest difference from Hankel integrals": float(max(errors)),
    }


def _stress(dataset: xr.Dataset) -> np.ndarray[Any, np.dtype[np.float64]]:
    """Stress on the axis over p0, tensor components."""
    return np.asarray(dataset["axis_stress"].isel(step=-1).values / COATED.peak)


@cache
def _known(ratio: float, friction: float, depth: float) -> np.ndarray[Any, np.dtype[np.float64]]:
    """Independent solution on the axis."""
    from eigencontact_verification.oracles.coated_stress import sliding_stress

    return np.asarray(sliding_stress(oracle(ratio), 0.0, 0.0, depth * _A, friction=friction) / COATED.peak)


def _oracle_stress(variant: Variant, depth: float) -> np.ndarray[Any, np.dtype[np.float64]]:
    return _known(variant.values["E₁/E₂"], variant.values["μ"], depth)


def _draw_map(found: Sequence[Finished]) -> Figure:
    ratios = levels(found, "E₁/E₂")
    frictions = levels(found, "μ")
    highest = max(float(von_mises(item.dataset, COATED).max()) for item in found)
    figure = new_figure(2.6 * len(frictions) + 1.0, 2.1 * len(ratios) + 0.3)
    panels = figure.subplots(len(ratios), len(frictions), squeeze=False, sharex=True, sharey=True)
    for item in found:
        row, column = ratios.index(item["E₁/E₂"]), frictions.index(item["μ"])
        image = draw_section(panels[row, column], item.dataset, highest, item.variant.label)
        place = item["at x / h"], item["at z / h"]
        panels[row, column].plot(*place, "x", color="black", markersize=5, clip_on=False)
    for panel in panels[:-1].ravel():
        panel.set_xlabel("")
    for panel in panels[:, 1:].ravel():
        panel.set_ylabel("")
    figure.colorbar(image, ax=panels, shrink=0.7, label="von Mises stress $/p_0$ (largest: cross)")
    return figure


def _lines(axes: Axes, found: Sequence[Finished], component: str, tints: Sequence[str]) -> None:
    """A component along the axis, with markers of the independent solution."""
    index = _COMPONENTS[component]
    for item, tint in zip(found, tints, strict=True):
        depth = item.dataset["axis_z"].values / _A
        axes.plot(*split(depth, _stress(item.dataset)[index]), "-", color=tint, label=item.variant.label)
        known = [_oracle_stress(item.variant, z)[index] for z in _MARKERS]
        axes.plot(known, _MARKERS, "x", color="black", markersize=3.6)
    axes.axhline(1.0, color="grey", linewidth=0.6)
    axes.set(xlabel=f"$\\sigma_{{{component}}}/p_0$", ylim=(2.5, 0.0))


def _draw_axis(found: Sequence[Finished]) -> Figure:
    frictions = levels(found, "μ")
    ratios = levels(found, "E₁/E₂")
    middle = frictions[len(frictions) // 2]
    chosen = having(found, "μ", middle)
    figure = new_figure(9.6, 3.2)
    *panels, last = figure.subplots(1, 4, sharey=True)
    tints = [colour(ratios.index(item["E₁/E₂"])) for item in chosen]
    for panel, component in zip(panels, _COMPONENTS, strict=True):
        _lines(panel, chosen, component, tints)
        panel.set_title(f"μ = {middle:g}")
    for friction, dash in zip(frictions, ("-", "--", ":"), strict=False):
        for item in having(found, "μ", friction):
            tint = colour(ratios.index(item["E₁/E₂"]))
            depth = item.dataset["axis_z"].values / _A
            last.plot(*split(depth, _stress(item.dataset)[4]), dash, color=tint)
    last.axhline(1.0, color="grey", linewidth=0.6)
    last.set(xlabel="$\\sigma_{xz}/p_0$", title="all μ", ylim=(2.5, 0.0))
    panels[0].set_ylabel("$z/h$")
    for n, ratio in enumerate(ratios):
        last.plot([], [], "-", color=colour(n), label=f"$E_1/E_2$ = {ratio:g}")
    for friction, dash in zip(frictions, ("-", "--", ":"), strict=False):
        last.plot([], [], dash, color="grey", label=f"μ = {friction:g} (on the right)")
    last.plot([], [], "x", color="black", markersize=3.6, label="Hankel integrals")
    legend_beside(figure, last)
    return figure


STUDIES = (
    Study(
        name="coating-sliding",
        title="Sphere sliding over soft and hard coatings: von Mises stress in section",
        repeats="thesis figure 4.10 (cases CO and CO-5)",
        scene=_scene,
        label=_LABEL,
        rows=_ROWS,
        coarse=every({"E₁/E₂": (0.5, 2.0), "μ": (0.5,)}),
        read=_read_map,
        draw=_draw_map,
        remark="Under friction the stress near the surface rises slowly with smaller depth; here it ends at 0.01 h.",
    ),
    Study(
        name="coating-sliding-axis",
        title="Sphere sliding over soft and hard coatings: stress on the axis through the interface",
        repeats="thesis figures 4.11 and 4.12 (case CO-6)",
        scene=partial(_scene, axis=True),
        label=_LABEL,
        rows=_ROWS,
        coarse=every({"E₁/E₂": (0.5, 2.0), "μ": (0.25,)}),
        read=_read_axis,
        draw=_draw_axis,
    ),
)
