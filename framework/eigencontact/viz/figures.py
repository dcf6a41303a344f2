"""All pictures that stored results support."""

from __future__ import annotations

import gc
import json
from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from eigencontact.viz.fatigue import fatigue_pictures
from eigencontact.viz.friction import dissipation_map, dissipation_profile, shear_map, shear_profiles
from eigencontact.viz.friction_history import LONG_HISTORY, fretting_loops, is_a_loop, zone_strip, zones_of_line
from eigencontact.viz.history import history_panels, history_words, load_history, vanishes, varies, zones_change
from eigencontact.viz.outline import coatings
from eigencontact.viz.plastic import (
    load_depth,
    loaded_step,
    plastic_history,
    plastic_section,
    plastic_surfaces,
    unloads,
)
from eigencontact.viz.profile import mean_profile, stress_profile
from eigencontact.viz.remembered import DAMAGE, plastic_strains, remembered_fields, yields
from eigencontact.viz.rolling import coverage_map, passing_history, passing_varies, rolls, struck
from eigencontact.viz.section import drawable, equivalent_of, stress_section
from eigencontact.viz.style import is_line, moment, save
from eigencontact.viz.surface import (
    cause,
    displacement_profiles,
    exposed_map,
    homogeneous_words,
    pressure_map,
    pressure_profiles,
    several_exposed,
    uplift_map,
)
from eigencontact.viz.wear import loop_cycles, wear_history, worn_coating, worn_loops, worn_map, worn_profiles
from eigencontact.viz.worn import interfaces, wears

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator
    from pathlib import Path

    from matplotlib.figure import Figure

    Picture = tuple[str, str, Callable[[], Figure]]
    from eigencontact.results.stored import Results

__all__ = ["draw_all", "standard_pictures"]

#: Fewer steps than this are no loop.
LOOP_STEPS = 3


def draw_all(
    dataset: Results,
    folder: Path,
    step: int | None = None,
    *,
    solid: bool = False,
    share: tuple[int, int] = (0, 1),
    kind: str = "png",
    dpi: int | None = None,
) -> dict[str, str]:
    """Draw the pictures of one step, and of a history of several steps; returns names and descriptions.

    Fields that are zero everywhere have no picture, nor have histories that change by no more than the resolution.

    Parameters
    ----------
    folder : Path
        Existing folder for the files.
    step : int, optional
        Position along ``step`` of the fields to draw; by default the last, or that of the largest pressure where the
        geometry rolls over elastic bodies that do not wear (in the last it may have left what it rolled over). Where
        the last leaves no pressure, that and the shear are those of the largest load, and sections are drawn at both.
    solid : bool
        Whether to draw surfaces in space, which takes VTK.
    share : (int, int)
        Of several processes that share the work, which one this is, from 0, and how many they are.
    kind, dpi : str, int
        Format, ``"png"``, ``"pdf"`` or ``"svg"``; dots per inch, by default those of the look in use.

    Raises
    ------
    ResultsError
        When a picture cannot be stored.
    """
    pictures = standard_pictures(dataset, step, solid=solid)
    named_pictures = [(f"{name.removesuffix('.png')}.{kind}", sentence, draw) for name, sentence, draw in pictures]
    for name, sentence, draw in named_pictures[share[0] :: share[1]]:
        save(draw(), folder / name, dpi, sentence)
        gc.collect()  # a figure refers to itself
    return {name: sentence for name, sentence, _ in named_pictures}


def standard_pictures(dataset: Results, step: int | None = None, *, solid: bool = False) -> list[Picture]:
    """File name, sentence and function of each picture that `draw_all` draws."""
    loaded, worn_step = step, -1 if step is None else step
    if step is None:
        stays = yields(dataset) or "worn_depth" in dataset
        step = int(dataset["max_pressure"].values.argmax()) if rolls(dataset) and not stays else -1
        loaded = loaded_step(dataset) if step == -1 else step
    assert loaded is not None
    pictures = [
        *_surface(dataset, step, loaded),
        *_regions(dataset, step, loaded),
        *_plastic(dataset, step, solid=solid),
        *_friction(dataset, loaded),
        *_wear(dataset, worn_step),
        *fatigue_pictures(dataset),
    ]
    if struck(dataset):
        sentence = "Number of impacts at each place; dots are their middles."
        pictures.append(("coverage.png", sentence, partial(coverage_map, dataset)))
    elif rolls(dataset) and passing_varies(dataset):
        sentence = "Largest pressure, and stress at points, over the position of the moving body."
        pictures.append(("passing.png", sentence, partial(passing_history, dataset)))
    load_depth_drawn = any(name == "load-depth.png" for name, *_ in pictures)
    if (panels := history_panels(dataset)) and not load_depth_drawn and not rolls(dataset):
        pictures.append(("history.png", history_words(panels), partial(load_history, dataset)))
    return pictures


def _surface(dataset: Results, step: int, loaded: int) -> Iterator[Picture]:
    """Pictures of the pressure after one step, and of the displacement by eigenstrain after another."""
    outlined = "outline" in dataset
    if not vanishes(dataset, ["pressure"], loaded):
        comparison = " with the closed form" if "reference_pressure" in dataset else ""
        homogeneous = homogeneous_words(dataset)
        comparison = f" with the closed form of the {homogeneous}" if homogeneous else comparison
        when, lines = moment(dataset, loaded), "; dashed lines are inclusions below" if outlined else ""
        if not is_line(dataset):
            sentence = f"Contact pressure, cut to the contact{when}{lines}."
            yield "pressure.png", sentence, partial(pressure_map, dataset, loaded)
        sentence = f"Contact pressure {_along(dataset)}{comparison}{when}; markers are computed cells."
        yield "pressure-profiles.png", sentence, partial(pressure_profiles, dataset, loaded)
    if not vanishes(dataset, ["residual_displacement_z"], step):
        when, lines = moment(dataset, step), "; lines are outlines of the inclusions from above" if outlined else ""
        sentence = f"Displacement of the surface out of the body by {cause(dataset)}{when}{lines}."
        if not is_line(dataset):
            yield "uplift.png", sentence, partial(uplift_map, dataset, step)
        sentence = f"Surface displacement by {cause(dataset)} {_along(dataset)}{when}."
        yield "uplift-profiles.png", sentence, partial(displacement_profiles, dataset, step)


def _regions(dataset: Results, step: int, loaded: int) -> Iterator[Picture]:
    """Pictures of the stress in regions; sections also at the largest load if that is another step."""
    when = moment(dataset, step)
    for region, region_kind in drawable(dataset).items():
        field = f"{region}_{equivalent_of(dataset, region)}"
        stressed = not vanishes(dataset, [field], step)
        if region_kind == "profile":
            if stressed:
                sentence = f"Stresses along the line {region!r}{when}."
                yield f"{region}.png", sentence, partial(stress_profile, dataset, region, step)
            continue
        if stressed:
            sentence = f"Equivalent stress on the section {region!r}{when}; a cross marks the largest value"
            sentence += ", a bar above or a line the contact." if "pressure" in dataset else "."
            sentence += " Lines are outlines of inclusions." if f"{region}_outline" in dataset else ""
            yield f"{region}.png", sentence, partial(stress_section, dataset, region, step)
        if loaded != step and not vanishes(dataset, [field], loaded):
            sentence = f"The same section {region!r} under the largest load{moment(dataset, loaded)}."
            yield f"{region}-loaded.png", sentence, partial(stress_section, dataset, region, loaded)
        if json.loads(dataset.attrs["regions"])[region]["shape"] == "volume" and yields(dataset):
            sentence = f"Stresses along the surface, means over each depth of {region!r}{when}."
            yield f"{region}-means.png", sentence, partial(mean_profile, dataset, region, step)


def _plastic(dataset: Results, step: int, *, solid: bool) -> Iterator[Picture]:
    """Pictures of plastic strain and damage, and of loading and unloading."""
    if not yields(dataset):
        return
    when = moment(dataset, step)
    largest = f"on the section through its largest value{when}; the line is at 5 % of that value."
    second = {1: "", 2: "-second"}
    for field in plastic_strains(dataset, step):
        name, sentence = f"plastic-strain{second[field.body]}.png", f"Equivalent plastic strain {largest}"
        yield name, sentence, partial(plastic_section, dataset, field, step)
        if solid:
            name, sentence = f"plastic-surfaces{second[field.body]}.png", "Surfaces of equal plastic strain, cut open"
            yield name, f"{sentence}{when}.", partial(plastic_surfaces, dataset, field, step)
    for field in remembered_fields(dataset, step, DAMAGE):
        labels = ("Damage", "Lost fraction of the stiffness [%]")
        name, sentence = f"damage{second[field.body]}.png", f"Damage {largest}"
        yield name, sentence, partial(plastic_section, dataset, field, step, labels)
    if unloads(dataset) and not rolls(dataset):
        yield "load-depth.png", "Normal load over approach during loading and unloading.", partial(load_depth, dataset)
    prefix = next((str(name)[: -len("_max_strain")] for name in dataset if str(name).endswith("_max_strain")), None)
    if prefix is None or f"{prefix}_volume" not in dataset or dataset.sizes["step"] < LOOP_STEPS:
        return
    if any(varies(dataset[f"{prefix}_{name}"].values) for name in ("max_strain", "volume")):
        sentence = "Largest plastic strain and plastic volume, step by step."
        yield "plastic-history.png", sentence, partial(plastic_history, dataset, prefix)


def _friction(dataset: Results, step: int) -> Iterator[Picture]:
    """Pictures of a run with friction: of one step, and from three steps on of the history."""
    if "contact_zone" not in dataset:
        return
    closed_form = any(_holds(dataset, f"reference_shear_{axis}", step) for axis in "xy")
    comparison = " with the closed form" if closed_form else ""
    when = moment(dataset, step)
    if not vanishes(dataset, ["shear_x", "shear_y"], step):
        if not is_line(dataset):
            yield "shear.png", f"Shear traction as arrows over stick and slip{when}.", partial(shear_map, dataset, step)
        sentence = f"Shear traction {_along(dataset)}{comparison}, and the bound of friction{when}."
        yield "shear-profiles.png", sentence, partial(shear_profiles, dataset, step)
    if np.nanmax(dataset["dissipated_energy_density"][step].values) > 0:
        draw = dissipation_profile if is_line(dataset) else dissipation_map
        yield "dissipation.png", f"Work of friction per area{when}.", partial(draw, dataset, step)
    if dataset.sizes["step"] < LOOP_STEPS:
        return
    if is_a_loop(dataset):
        sentence = "Tangential load over shift (moment over twist), with the work of friction."
        yield "loop.png", sentence, partial(fretting_loops, dataset)
    if zones_change(dataset, zones_of_line(dataset)[0]):
        sentence = "Stick and slip on a line through the contact, step by step."
        yield "zones.png", sentence, partial(zone_strip, dataset)


def _wear(dataset: Results, step: int) -> Iterator[Picture]:
    """Pictures of surfaces that wear: of one step, and of the history."""
    if not wears(dataset):
        return
    when = moment(dataset, step)
    if not is_line(dataset):
        yield "worn-depth.png", f"Worn depth of both bodies together{when}.", partial(worn_map, dataset, step)
    sentence = f"Surfaces of both bodies before and after wear, and the worn depth, {_along(dataset)}{when}."
    yield "worn-profiles.png", sentence, partial(worn_profiles, dataset, step)
    if any(interfaces(dataset, body) for body in (1, 2)) or coatings(dataset):
        sentence = f"Worn surfaces over the interfaces of layers and coatings, {_along(dataset)}{when}."
        yield "worn-coating.png", sentence, partial(worn_coating, dataset, step)
    if several_exposed(dataset, step) and not is_line(dataset):
        sentence = f"Materials at the surface, by name{when}; the line is the outline of the contact."
        yield "exposed-materials.png", sentence, partial(exposed_map, dataset, step)
    if dataset.sizes["step"] >= LOOP_STEPS:
        sentence = "Worn volume and depth, largest pressure and contact area over the history of wear."
        yield "wear-history.png", sentence, partial(wear_history, dataset)
    if loop_cycles(dataset) and dataset.sizes["step"] > LONG_HISTORY:  # of fewer steps the loops show all cycles
        yield "wear-loops.png", "Loops of selected cycles, drawn over each other.", partial(worn_loops, dataset)


def _along(dataset: Results) -> str:
    """Lines of the profiles, in words."""
    return "along x" if is_line(dataset) else "along x and y"


def _holds(dataset: Results, name: str, step: int) -> bool:
    """Whether a closed form is stored and valid at this step."""
    return name in dataset and not np.isnan(dataset[name][step].values).any()
