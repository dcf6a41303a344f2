"""Small pictures of the figures of the thesis: one panel of the figure of the study behind each."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import ExitStack, closing
from dataclasses import replace
from io import BytesIO
from pathlib import Path
from typing import IO, TYPE_CHECKING, cast

from eigencontact.engines.cluster import Cluster
from eigencontact.errors import SceneError
from eigencontact_verification.studies.catalogue import STUDIES
from eigencontact_verification.studies.formula import evaluate
from eigencontact_verification.studies.run import Failed, run_study
from eigencontact_verification.studies.study import Finished, Study
from eigencontact_verification.thesis.entries import Entry

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = ["draw_pictures", "picture_name"]

#: Width and height [inch], and dots to an inch.
SIZE, DOTS = (3.3, 2.5), 120
#: Colours that a picture keeps: a third of its bytes, and no difference that is seen.
COLOURS = 64
#: Labels that have room in it, each once.
MOST_LABELS = 6


def picture_name(entry: Entry) -> str:
    """Name of the file of an entry's picture."""
    return f"{entry.name.replace(' ', '-')}.png"


def draw_pictures(
    entries: Sequence[Entry],
    runs: Path,
    folder: Path,
    *,
    coarse: bool,
    workers: int = 1,
    cluster: Cluster | None = None,
    tell: Callable[[str], None],
) -> list[Path]:
    """Run all variants of the studies behind some figures, and draw a panel of each.

    Parameters
    ----------
    runs : Path
        Results of the variants, as those of `eigencontact_verification.thesis.judge.judged_claims`.
    folder : Path
        Of the pictures.
    coarse, workers, cluster, tell
        As for `judged_claims`.

    Raises
    ------
    SceneError
        A study without results, or without the panel that an entry names.
    """
    folder.mkdir(parents=True, exist_ok=True)
    files = []
    for name in dict.fromkeys(entry.study for entry in entries if entry.study):
        tell(f"{name}, pictures")
        study, place = STUDIES.find(name), runs / ("quick" if coarse else "full")
        with ExitStack() as opened:
            variants = []
            for item in run_study(study, place, coarse=coarse, workers=workers, cluster=cluster):
                if not isinstance(item, Failed):
                    opened.enter_context(closing(item.dataset))
                    variants.append(item)
            variants.sort(key=lambda variant: variant.place)
            if not variants:
                raise SceneError(f"{name}: no variant has results for a picture")
            for entry in entries:
                figure = _drawn(entry, study, variants) if entry.study == name else None
                if figure is not None:
                    files.append(folder / picture_name(entry))
                    _write(figure, files[-1])
    return files


def _drawn(entry: Entry, study: Study, variants: Sequence[Finished]) -> Figure | None:
    """One panel; of one that stands for several variants the last. None without a variant for it."""
    from eigencontact.viz.style import paper_style
    from eigencontact_verification.studies.figure import draw_study, panels_of

    panels = study.figure["panel"]
    if entry.panel >= len(panels):
        raise SceneError(f"thesis: {entry.number} panel must be below {len(panels)} (got {entry.panel})")
    panel = panels[entry.panel]
    if entry.only:
        variants = [
            variant
            for variant in variants
            if bool(evaluate(entry.only, variant.context, f"thesis: {entry.number} only"))
        ]
    shown = panels_of(study, panel, variants) if variants else []
    if not shown:  # a first look leaves variants out
        return None
    if "each" in panel:
        variants = shown[-1][1]
    small = replace(study, sources=(), figure={"panel": [panel], "size": SIZE, "legend": "none", "columns": 1})
    with paper_style():
        figure = draw_study(small, variants)
        axes = figure.axes[0]
        labels = dict(reversed(list(zip(*reversed(axes.get_legend_handles_labels()), strict=True))))
        if labels:
            chosen = list(labels)[:MOST_LABELS]
            legend = axes.legend(
                [labels[variant] for variant in chosen], chosen, fontsize=6, framealpha=0.7, handlelength=1.5
            )
            legend.set_in_layout(False)
    return figure


def _write(figure: Figure, path: Path) -> None:
    from PIL import Image

    from eigencontact.results.atomic import replacing

    drawn = BytesIO()
    figure.savefig(drawn, format="png", dpi=DOTS)
    with Image.open(drawn) as image, replacing(path, f"picture {path.name}", lasting=False) as sink:
        image.convert("RGB").quantize(COLOURS).save(cast("IO[bytes]", sink), format="PNG", optimize=True)
