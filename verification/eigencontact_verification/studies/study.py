"""A study: variants of a scene, what is read off each of them, and a figure of all."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.figure import Figure

    from eigencontact.scene.schema import Scene

__all__ = ["Finished", "Row", "Study", "Variant", "VariantsOf", "run_study", "write_study"]

#: Numbers of one variant, by name with its unit.
Row = dict[str, float | str]


@dataclass(frozen=True)
class Variant:
    """One scene of a study.

    Attributes
    ----------
    label : str
        For legends and for the folder of its results; unique in the study.
    scene : Scene
        What is run.
    values : mapping of str to float
        Parameters that the study varies.
    """

    label: str
    scene: Scene
    values: Mapping[str, float]


class VariantsOf(Protocol):
    """Makes the variants of a study; coarse for a first look and for tests: fewer of them, and fewer cells."""

    def __call__(self, *, coarse: bool) -> Sequence[Variant]:
        """Variants in the order of the figure."""
        ...


@dataclass(frozen=True, kw_only=True)
class Study:
    """A question asked of several variants of a scene.

    Attributes
    ----------
    name : str
        What is typed.
    title : str
        One line: what is varied and what is looked at.
    repeats : str
        Where the trend was published, for comparison by eye.
    variants : callable
        Makes the variants.
    read : callable
        Numbers of a finished variant.
    draw : callable
        Figure of all.
    remark : str
        What is known of the trend, and of its limits.
    """

    name: str
    title: str
    repeats: str
    variants: VariantsOf
    read: Callable[[Variant, xr.Dataset], Row]
    draw: Callable[[Sequence[Finished]], Figure]
    remark: str = ""


@dataclass(frozen=True)
class Finished:
    """A variant with its results; `row` is what the study reads off them."""

    variant: Variant
    dataset: xr.Dataset
    row: Row


def run_study(study: Study, folder: Path, *, coarse: bool = False) -> Iterator[Finished]:
    """Run the variants one by one, each into a folder of its own; finished ones are read again, not run again.

    A folder that holds results of another scene is written anew.
    """
    import eigencontact as ec

    for variant in study.variants(coarse=coarse):
        place = folder / study.name / _plain(variant.label)
        scene = variant.scene
        if _holds(place, scene):
            dataset = ec.open_results(place)
        else:
            dataset = ec.run(scene, place, overwrite=place.exists()).dataset
            (place / _MARK).write_text(_text(scene), encoding="utf-8")
        yield Finished(variant, dataset, study.read(variant, dataset))


def write_study(study: Study, found: Sequence[Finished], folder: Path) -> list[Path]:
    """Write figure (PNG) and numbers (JSON) of a study; return the files."""
    from eigencontact.viz.style import save

    folder.mkdir(parents=True, exist_ok=True)
    picture, numbers = folder / f"{study.name}.png", folder / f"{study.name}.json"
    save(study.draw(found), picture)
    rows: list[dict[str, Any]] = [{"variant": item.variant.label, **item.variant.values, **item.row} for item in found]
    content = {"study": study.name, "title": study.title, "repeats": study.repeats, "remark": study.remark}
    numbers.write_text(json.dumps({**content, "variants": rows}, indent=2, ensure_ascii=False) + "\n", encoding="utf-8")
    return [picture, numbers]


#: File beside the results of a variant: the scene that they belong to.
_MARK = "study.json"


def _text(scene: Scene) -> str:
    from eigencontact import __version__

    return json.dumps({"version": __version__, "scene": scene.resolved()}, sort_keys=True, indent=1)


def _holds(place: Path, scene: Scene) -> bool:
    mark = place / _MARK
    return mark.exists() and mark.read_text(encoding="utf-8") == _text(scene)


def _plain(label: str) -> str:
    """Label as the name of a folder."""
    return "".join(letter if letter.isalnum() or letter in ".-" else "_" for letter in label)
