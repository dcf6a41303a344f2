"""All pictures that stored results support."""

from __future__ import annotations

from typing import TYPE_CHECKING

from eigencontact.viz.history import load_history
from eigencontact.viz.residual import displacement_profiles, uplift_map
from eigencontact.viz.section import drawable, stress_profile, stress_section
from eigencontact.viz.style import save
from eigencontact.viz.surface import pressure_map, pressure_profiles

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

    import xarray as xr
    from matplotlib.figure import Figure

__all__ = ["draw_all"]


def draw_all(dataset: xr.Dataset, folder: Path, step: int = -1) -> dict[str, str]:
    """Draw the pictures of one step, and of the history where there are several steps.

    Parameters
    ----------
    dataset : xarray.Dataset
        Results of a run (`eigencontact.results.reader.open_results`).
    folder : Path
        Existing folder for the PNG files.
    step : int
        Position along ``step`` of the fields to draw; the last by default.

    Returns
    -------
    dict of str to str
        File name and one sentence on what it shows.

    Raises
    ------
    ResultsError
        When a picture cannot be stored.
    """
    wanted: list[tuple[str, str, Callable[[], Figure]]] = []
    if "pressure" in dataset:
        beside = " beside the closed form" if "reference_pressure" in dataset else ""
        wanted += [
            ("pressure.png", "Contact pressure, cut to the contact.", lambda: pressure_map(dataset, step)),
            (
                "pressure-profiles.png",
                f"Contact pressure along x and y{beside}; markers are computed cells.",
                lambda: pressure_profiles(dataset, step),
            ),
        ]
    if "residual_displacement_z" in dataset:
        wanted += [
            (
                "uplift.png",
                "Uplift of the surface by eigenstrain; lines are outlines of the inclusions from above.",
                lambda: uplift_map(dataset, step),
            ),
            (
                "uplift-profiles.png",
                "Surface displacement by eigenstrain along x and y.",
                lambda: displacement_profiles(dataset, step),
            ),
        ]
    for region, how in drawable(dataset).items():
        if how == "section":
            sentence = f"Equivalent stress on the section {region!r}; a cross marks the largest value."
            wanted.append((f"{region}.png", sentence, lambda region=region: stress_section(dataset, region, step)))  # type: ignore[misc]
        else:
            sentence = f"Stresses along the line {region!r}."
            wanted.append((f"{region}.png", sentence, lambda region=region: stress_profile(dataset, region, step)))  # type: ignore[misc]
    if dataset.sizes["step"] > 1 and {"normal_load", "approach", "contact_area"} <= set(dataset.data_vars):
        sentence = "Normal load against approach, and contact area against normal load."
        wanted.append(("history.png", sentence, lambda: load_history(dataset)))
    described = {}
    for name, sentence, draw in wanted:
        save(draw(), folder / name)
        described[name] = sentence
    return described
