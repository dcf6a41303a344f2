"""A study: a scene and a table of its variants, what is read off each of them, and a figure of all."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import product
from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.figure import Figure

    from eigencontact.scene.schema import Scene

__all__ = ["Finished", "Row", "Study", "Variant", "every", "having", "levels", "run_study", "write_study"]

#: Numbers of one variant, by name with its unit.
Row = dict[str, float]


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


class SceneOf(Protocol):
    """Makes the scene of some values; coarse for a first look and for tests: fewer cells and steps."""

    def __call__(self, values: Mapping[str, float], /, *, coarse: bool) -> Scene:
        """Scene of these values."""
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
    scene : callable
        ``scene(values, coarse=coarse)``, the scene of a variant.
    label : callable
        Label of values; mostly the ``format_map`` of a text with the parameters as fields.
    rows : sequence of mapping of str to float
        Parameters of the variants, by name with unit, in the order of the figure.
    coarse : sequence of mapping of str to float
        Those of a first look and of tests.
    read : callable
        Numbers of a finished variant.
    draw : callable
        Figure of all, in the style of the papers.
    remark : str
        What is known of the trend, and of its limits.
    """

    name: str
    title: str
    repeats: str
    scene: SceneOf
    label: Callable[[Mapping[str, float]], str]
    rows: Sequence[Mapping[str, float]]
    coarse: Sequence[Mapping[str, float]]
    read: Callable[[Variant, xr.Dataset], Row]
    draw: Callable[[Sequence[Finished]], Figure]
    remark: str = ""

    def variants(self, *, coarse: bool) -> list[Variant]:
        """One variant a row."""
        rows = self.coarse if coarse else self.rows
        return [Variant(self.label(row), self.scene(row, coarse=coarse), row) for row in rows]


def every(values: Mapping[str, Sequence[float]]) -> Sequence[Mapping[str, float]]:
    """Rows of each value of the first parameter with each of the second, and so on; the last changes fastest.

    Examples
    --------
    >>> every({"E": [0.5, 2.0], "h": [1.0]})
    [{'E': 0.5, 'h': 1.0}, {'E': 2.0, 'h': 1.0}]
    """
    return [dict(zip(values, row, strict=True)) for row in product(*values.values())]


@dataclass(frozen=True)
class Finished:
    """A variant with its results; `row` is what the study reads off them."""

    variant: Variant
    dataset: xr.Dataset
    row: Row

    def __getitem__(self, name: str) -> float:
        """Value of a parameter or of a reading."""
        return self.row[name] if name in self.row else self.variant.values[name]


def levels(found: Sequence[Finished], name: str, *, falling: bool = False) -> list[float]:
    """Values of a parameter that occur, in order."""
    return sorted({item.variant.values[name] for item in found}, reverse=falling)


def having(found: Sequence[Finished], name: str, value: float) -> list[Finished]:
    """Variants with this value of a parameter."""
    return [item for item in found if item.variant.values.get(name) == value]


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
    from eigencontact.viz.style import paper_style, save

    folder.mkdir(parents=True, exist_ok=True)
    picture, numbers = folder / f"{study.name}.png", folder / f"{study.name}.json"
    with paper_style():
        figure = study.draw(found)
    save(figure, picture)
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
