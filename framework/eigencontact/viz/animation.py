"""Animations of a load history: choice of the pictures in a frame, and the frames."""

from __future__ import annotations

import json
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from eigencontact.core.names import ANIMATION
from eigencontact.errors import SceneError
from eigencontact.viz.frame import Film, Frame
from eigencontact.viz.friction import driven, shear_map
from eigencontact.viz.friction_history import fretting_loops
from eigencontact.viz.history import history_panels, load_history
from eigencontact.viz.line_frame import pressure_curve, shear_curve
from eigencontact.viz.movie import write_movie
from eigencontact.viz.plastic import load_depth
from eigencontact.viz.remembered import yields
from eigencontact.viz.rolling import rolls
from eigencontact.viz.section import drawable, stress_section
from eigencontact.viz.style import new_figure, paper_style
from eigencontact.viz.surface import pressure_map
from eigencontact.viz.wear import worn_profiles
from eigencontact.viz.worn import ends_of_cycles, wears

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator
    from pathlib import Path

    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    Draw = Callable[..., Figure]
    from eigencontact.results.stored import Results

__all__ = ["FRAMES", "Subject", "animate", "frames", "jumps", "subject_of"]

#: Longer histories are thinned to so many frames.
FRAMES = 80
#: Resolution of the frames [dots per inch]: letters of 9 points are 20 dots high.
DPI = 160
#: Rounds of the layout until axes of equal scales stay in place: after two within 0.1 % of the frame, after one 5 %.
ROUNDS = 2
#: Room around the pictures [inch].
ROOM = 0.09


@dataclass(frozen=True)
class Subject:
    """Content of the frames of an animation: pictures, description, and whether they are stacked.

    Each picture is a function that draws when called with ``step`` (a position) and ``on`` (a `Frame`).
    """

    pictures: tuple[Draw, ...]
    sentence: str
    stacked: bool = False


def subject_of(dataset: Results) -> Subject | None:
    """Pictures for the frames of a history; None for a single step and for results without a picture."""
    if dataset.sizes["step"] < 2:
        return None
    regions = json.loads(dataset.attrs["regions"])
    planes = [
        name for name, kind in drawable(dataset).items() if kind == "section" and regions[name]["shape"] == "plane"
    ]
    draw_pressure, draw_shear = (pressure_curve, shear_curve) if dataset.sizes["y"] == 1 else (pressure_map, shear_map)
    if wears(dataset) and "pressure" in dataset:
        pictures = (partial(worn_profiles, dataset), partial(draw_pressure, dataset))
        caption = "Worn surfaces over the initial ones, and the contact pressure."
        return Subject(pictures, caption, stacked=rolls(dataset))
    section: list[Draw] = [partial(stress_section, dataset, name) for name in planes[:1]]
    below = f", over the stress on {planes[0]!r}" if planes else ""
    if "pressure" not in dataset:
        return Subject(tuple(section), f"Stress on {planes[0]!r}.") if planes else None
    pressure = partial(draw_pressure, dataset)
    if rolls(dataset):
        return Subject((pressure, *section), f"Contact pressure as the geometry travels{below}.", stacked=True)
    if "contact_zone" in dataset:
        shear = partial(draw_shear, dataset)
        if driven(dataset):
            return Subject((shear, partial(fretting_loops, dataset)), "Shear over stick and slip, beside the loop.")
        return Subject((shear, pressure), "Shear over stick and slip, beside the contact pressure.")
    has_course = {"normal_load", "approach", "contact_area"} <= set(dataset.data_vars)
    if has_course and yields(dataset):
        second_picture = f"the stress on {planes[0]!r}" if section else "the contact pressure"
        sentence = f"Load against depth, beside {second_picture}."
        if section and dataset.sizes.get("history_step") == dataset.sizes["step"]:
            sentence += " The line is around what has yielded."
        return Subject((section[0] if section else pressure, partial(load_depth, dataset)), sentence)
    if not section and history_panels(dataset):
        return Subject(
            (pressure, partial(load_history, dataset)), "Contact pressure through the load history.", stacked=True
        )
    return Subject((pressure, *section), f"Contact pressure{below}.", stacked=bool(section))


def thinned(dataset: Results, most: int = FRAMES) -> tuple[int, ...]:
    """At most a number of evenly spaced positions along ``step``, with the first and the last.

    Of cycles that wear they are the ends of those that were solved, unless the geometry travels in them.
    """
    worn = wears(dataset) and not rolls(dataset)
    steps = ends_of_cycles(dataset) if worn else np.arange(dataset.sizes["step"])
    positions = np.rint(np.linspace(0, steps.size - 1, min(most, steps.size))).astype(int)
    return tuple(steps[np.unique(positions)].tolist())


def jumps(dataset: Results, steps: tuple[int, ...]) -> str:
    """Note about steps or cycles without a frame; empty if all have a frame."""
    if "cycles" in dataset and wears(dataset):
        most = float(np.diff(np.asarray(dataset["cycles"].values, dtype=float)[list(steps)]).max(initial=0.0))
        if most > 1:
            return f"Up to {most:.0f} cycles from one frame to the next"
    count = dataset.sizes["step"]
    return f"{len(steps)} of {count} steps have a frame" if len(steps) < count else ""


def frames(dataset: Results, subject: Subject) -> Iterator[Figure]:
    """Figure that is drawn again for every frame, with the same size, axes and colours."""
    film = Film(dataset, thinned(dataset))
    sizes = [draw(step=film.steps[0], on=Frame(film)).get_size_inches() for draw in subject.pictures]
    along, across = (1, 0) if subject.stacked else (0, 1)
    size = np.zeros(2)
    size[along], size[across] = sum(extent[along] for extent in sizes), max(extent[across] for extent in sizes)
    size = np.ceil(size * DPI / 2) * 2 / DPI  # of even numbers of pixels, as films ask for
    ratios = [extent[along] for extent in sizes]
    with paper_style():
        figure = new_figure(*size)
    figure.set_size_inches(*size)
    figure.set_dpi(DPI)
    figure.set_layout_engine("constrained", w_pad=ROOM, h_pad=ROOM)
    # Axes lie in all frames where the layout of the one in the middle puts them; it needs some rounds to settle.
    _draw(figure, subject, film, film.steps[len(film.steps) // 2], ratios)
    with paper_style():
        for _ in range(ROUNDS):
            figure.canvas.draw()
    places = [axes.get_position(original=True) for axes in _axes(figure)]
    figure.set_layout_engine("none")
    for step in film.steps:
        _draw(figure, subject, film, step, ratios)
        for axes, place in zip(_axes(figure), places, strict=False):
            axes.set_position(place)
        with paper_style():
            yield figure


def _draw(figure: Figure, subject: Subject, film: Film, step: int, ratios: list[float]) -> None:
    """Draw the pictures of one step into an empty figure."""
    figure.clear()
    (rows, columns), side = ((len(ratios), 1), "height") if subject.stacked else ((1, len(ratios)), "width")
    shares: dict[str, Any] = {f"{side}_ratios": ratios}
    panels: Any = figure.subfigures(rows, columns, squeeze=False, **shares)
    for draw, panel in zip(subject.pictures, panels.ravel(), strict=True):
        draw(step=step, on=Frame(film, panel))
    note = jumps(film.dataset, film.steps)
    figure.text(0.99, 0.005, note, ha="right", va="bottom", fontsize="x-small", color="0.4")


def _axes(figure: Figure) -> list[Axes]:
    return [axes for panel in figure.subfigs for axes in panel.axes]


def animate(dataset: Results, folder: Path, kind: Literal[True, "gif", "mp4"] = "gif") -> dict[str, str]:
    """Write the animation of a history into an existing folder; returns its file name and a description.

    `kind` is ``"gif"`` or True, or ``"mp4"`` where the program ffmpeg is installed. `SceneError` where there is nothing
    to animate (`subject_of`); `ResultsError` when it cannot be stored, or ffmpeg is missing or fails.
    """
    subject = subject_of(dataset)
    if subject is None:
        raise SceneError(
            "an animation must be of several load steps with contact or a plane of stress "
            f"(got {dataset.sizes['step']} of {dataset.attrs['title'] or 'a run'!r}); draw pictures alone"
        )
    name = f"{ANIMATION}.{kind if isinstance(kind, str) else 'gif'}"
    write_movie(frames(dataset, subject), folder / name)
    note = jumps(dataset, thinned(dataset))
    return {name: f"{subject.sentence} {note}." if note else subject.sentence}
