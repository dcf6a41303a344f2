"""A campaign as its file tells it: models, the reference that judges them, quantities, and where agreement is claimed.

The scene, its constants and what is varied are those of a study, so that a campaign is read as one: a study of the
model, and where another semi-analytical model judges, three studies of the reference, which differ in the constant that
is refined.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cache
from math import isclose
from pathlib import Path
from typing import Any

from eigencontact.errors import SceneError, nearest, shown
from eigencontact_verification.campaign.form import FORM, JUDGES, SHARED
from eigencontact_verification.reporting.bundled import bundled_names, find_file, read_toml
from eigencontact_verification.studies.form import checked
from eigencontact_verification.studies.formula import Context, evaluate
from eigencontact_verification.studies.study import Study, study_of

__all__ = ["FOLDER", "Campaign", "Model", "Quantity", "find", "names", "read_campaign"]

#: Where the bundled campaigns lie in the package.
FOLDER = "campaign"
#: Parts by which the ratios of both refinements may differ: cells come in whole numbers.
_RATIOS = 0.15


@dataclass(frozen=True, kw_only=True)
class Quantity:
    """What is compared of model and reference.

    Attributes
    ----------
    name : str
        In tables.
    formula, expect, scale, condition : str
        See ``quantity`` of `FORM`; empty: by default.
    tolerance : float
        Largest error that is agreement, a part of the scale.
    order : float
        Largest order of convergence that is believed.
    """

    name: str
    formula: str
    tolerance: float
    expect: str = ""
    scale: str = ""
    condition: str = ""
    order: float = 2.0


@dataclass(frozen=True, kw_only=True)
class Model:
    """A scene of a campaign with its variants, and what judges them.

    Attributes
    ----------
    study : Study
        Of what is judged.
    reference : tuple of Study
        Of the reference, coarse to fine; empty where finite elements judge.
    """

    study: Study
    reference: tuple[Study, ...] = ()


@dataclass(frozen=True, kw_only=True)
class Campaign:
    """Where a model is good.

    Attributes
    ----------
    name, title, trend : str
        What is typed; the question; what is known of the answer.
    judge : {"scene", "audit", "contact"}
        Who judges.
    models, coarse_models : tuple of Model
        Each scene; those of a first look.
    words, reference : str
        What is judged and what judges, in a few words.
    quantities : tuple of Quantity
        What is compared by another scene; finite elements compare what they can.
    tolerance : float
        See `FORM`.
    expect : str
        Where agreement is claimed; empty: everywhere.
    full_meshes : bool
        Whether finite elements take the meshes of a full verification.
    whole_scenes : bool
        Whether whole scenes are compared: each is then run in a process of its own, so that its memory is its own.
    ratio, coarse_ratio : float
        Of the refinements of the reference.
    drawn : mapping
        Table ``map``.
    sources : sequence of mapping
        Where the question was asked before.
    """

    name: str
    title: str
    trend: str
    judge: str
    models: tuple[Model, ...]
    coarse_models: tuple[Model, ...]
    words: str
    reference: str
    quantities: tuple[Quantity, ...]
    tolerance: float
    expect: str
    full_meshes: bool = False
    whole_scenes: bool = False
    ratio: float = 2.0
    coarse_ratio: float = 2.0
    drawn: Mapping[str, Any] = field(default_factory=dict)
    sources: Sequence[Mapping[str, Any]] = ()

    def claimed(self, names: Mapping[str, Any], quantity: Quantity | None = None) -> bool:
        """Whether agreement is claimed for a variant of these constants and parameters."""
        own = "" if quantity is None else quantity.expect
        told = f"{self.name}: expect" if not own else f"quantity {quantity.name!r}: expect" if quantity else ""
        return not (own or self.expect) or bool(evaluate(own or self.expect, Context(names), told))


@cache
def names() -> tuple[str, ...]:
    """Names of the bundled campaigns."""
    return bundled_names(FOLDER)


@cache
def find(name: str) -> Campaign:
    """Campaign of a file, or of the name of a bundled one.

    Raises
    ------
    SceneError
        No such campaign, with the nearest name; or a file that is none.
    """
    return read_campaign(*find_file(name, "campaign", FOLDER))


def read_campaign(path: Path, text: str | None = None) -> Campaign:
    """Campaign of a TOML file.

    Parameters
    ----------
    path : Path
        Its file; the name of the campaign is that of the file.
    text : str, optional
        Its contents, where they have been read.

    Raises
    ------
    SceneError
        What is wrong with it, by key.
    """
    given = read_toml(path, text, "campaign")
    table = checked(given, "campaign", f"campaign {path.stem}", needs=("title", "judge"), form=FORM)
    judge = str(table["judge"])
    if judge not in JUDGES:
        raise SceneError(f"judge must be one of {', '.join(JUDGES)} (got {judge!r}){nearest(judge, JUDGES)}")
    coarse = checked(table.get("coarse", {}), "coarse", "coarse", form=FORM)
    reference = _reference(table, judge)
    tolerance = _tolerance(table.get("tolerance", 0.02), "tolerance")
    scenes, few = _scenes(table, coarse)
    fine, first = _refined(reference, coarse)
    folder = path.resolve().parent if path.is_file() or text is None else None

    def models(chosen: Sequence[Any], levels: Mapping[str, Sequence[Any]], *, named: bool) -> tuple[Model, ...]:
        return tuple(
            Model(
                study=_study(path, table, coarse, scene, folder, named=named),
                reference=tuple(
                    _study(path, table, coarse, scene, folder, named=named, reference=reference, at=k, levels=levels)
                    for k in range(3 if levels else 0)
                ),
            )
            for scene in chosen
        )

    named = "scenes" in table
    found = Campaign(
        name=path.stem,
        title=str(table["title"]),
        trend=" ".join(str(table.get("trend", "")).split()),
        judge=judge,
        models=models(scenes, fine, named=named),
        coarse_models=models(few, first, named=named),
        words=str(table.get("model", "the model")),
        reference=str(reference.get("words", JUDGES[judge])),
        quantities=_quantities(table, judge, tolerance),
        tolerance=tolerance,
        expect=str(table.get("expect", "")),
        full_meshes=_meshes(table, judge),
        whole_scenes=named,
        ratio=_ratio(fine),
        coarse_ratio=_ratio(first),
        drawn=checked(table.get("map", {}), "map", "map", form=FORM),
        sources=[checked(one, "source", "source") for one in _tables(table.get("source", []))],
    )
    _look(found)
    return found


def _tables(given: Any) -> list[Any]:
    return list(given) if isinstance(given, list) else [given]


def _tolerance(given: Any, told: str) -> float:
    if isinstance(given, bool) or not isinstance(given, int | float) or not 0.0 < given < 1.0:
        raise SceneError(f"{told} must be between 0 and 1 (got {shown(given)}); 0.02 is two per cent of the quantity")
    return float(given)


def _reference(table: Mapping[str, Any], judge: str) -> Mapping[str, Any]:
    if judge != "scene":
        for key in ("reference", "quantity"):
            if key in table:
                raise SceneError(f"{key} must be with judge = 'scene' (got judge = {judge!r}); leave it out")
        return {}
    for key in ("reference", "quantity"):
        if key not in table:
            raise SceneError(f"campaign must have {key} with judge = 'scene': {FORM['campaign'][key]}")
    return checked(table["reference"], "reference", "reference", needs=("refine",), form=FORM)


def _meshes(table: Mapping[str, Any], judge: str) -> bool:
    """Whether finite elements take full meshes."""
    told, known = table.get("meshes", "quick"), ("quick", "full")
    if told not in known:
        raise SceneError(f"meshes must be one of {', '.join(known)} (got {shown(told)}){nearest(str(told), known)}")
    if judge == "scene" and "meshes" in table:
        raise SceneError("meshes must be with judge = 'audit' or 'contact' (got judge = 'scene'); leave it out")
    return bool(told == "full")


def _scenes(table: Mapping[str, Any], coarse: Mapping[str, Any]) -> tuple[list[Any], list[Any]]:
    """Scenes of the campaign, and those of a first look."""
    if ("scene" in table) == ("scenes" in table):
        raise SceneError("campaign must have either scene or scenes (got both or none)")
    if "scene" in table:
        return [table["scene"]], [table["scene"]]
    several = table["scenes"]
    if not isinstance(several, list) or not several or not all(isinstance(one, str) for one in several):
        raise SceneError(f"scenes must be an array of bundled scenes or files (got {shown(several)})")
    few = coarse.get("scenes", several)
    for one in few:
        if one not in several:
            raise SceneError(f"coarse.scenes must be some of scenes (got {one!r}){nearest(str(one), several)}")
    return several, list(few)


def _refined(
    reference: Mapping[str, Any], coarse: Mapping[str, Any]
) -> tuple[dict[str, list[Any]], dict[str, list[Any]]]:
    """Constant that is refined with its values; and with those of a first look."""
    if not reference:
        return {}, {}
    fine = _levels(reference["refine"], "reference.refine")
    first = _levels(coarse.get("refine", reference["refine"]), "coarse.refine")
    return fine, first


def _levels(given: Any, told: str) -> dict[str, list[Any]]:
    if not isinstance(given, Mapping) or len(given) != 1:
        raise SceneError(f"{told} must be a table of one constant and three values (got {shown(given)})")
    ((name, values),) = given.items()
    numbers = values if isinstance(values, list) else []
    if len(numbers) != 3 or not all(isinstance(one, int | float) and one > 0 for one in numbers):
        raise SceneError(f"{told}.{name} must be three positive numbers, coarse to fine (got {shown(values)})")
    first, second = numbers[1] / numbers[0], numbers[2] / numbers[1]
    if not (max(first, 1 / first) > 1.1 and isclose(first, second, rel_tol=_RATIOS)):
        raise SceneError(
            f"{told}.{name} must go from coarse to fine by one ratio above 1.1 (got {first:.3g} and {second:.3g})"
        )
    return {str(name): list(numbers)}


def _ratio(levels: Mapping[str, Sequence[float]]) -> float:
    """Size of elements of a level over that of the next finer one, by their geometric mean."""
    for values in levels.values():
        whole = (values[2] / values[0]) ** 0.5
        return float(max(whole, 1.0 / whole))
    return 2.0


def _study(
    path: Path, table: Mapping[str, Any], coarse: Mapping[str, Any], scene: Any, folder: Path | None, *, named: bool,
    reference: Mapping[str, Any] | None = None, at: int = 0, levels: Mapping[str, Sequence[Any]] | None = None,
) -> Study:  # fmt: skip
    """Study of the model, or of a level of the reference."""
    given = {key: table[key] for key in SHARED if key in table} | {"scene": scene}
    first = {key: coarse[key] for key in ("constants", "vary", "set") if key in coarse}
    if named:
        label = Path(str(scene)).stem
        varied = _tables(given.get("vary", {}))
        given["vary"] = [{"scene": [label], **one} for one in varied]
        if "vary" in first:
            first["vary"] = [{"scene": [label], **one} for one in _tables(first["vary"])]
    if levels and reference is not None:
        ((name, values),) = levels.items()
        refined = {name: values[at]}
        given["constants"] = {**given.get("constants", {}), **refined}
        first["constants"] = {**first.get("constants", {}), **refined}
        always = {"if": "1", **{key: reference[key] for key in ("set", "without") if key in reference}}
        given["when"] = [*_tables(given.get("when", [])), always, *_tables(reference.get("when", []))]
    return study_of({**given, "coarse": first}, path.stem, path.parent, folder)


def _quantities(table: Mapping[str, Any], judge: str, tolerance: float) -> tuple[Quantity, ...]:
    if judge != "scene":
        return ()
    found: list[Quantity] = []
    for n, given in enumerate(_tables(table["quantity"])):
        one = checked(given, "quantity", f"quantity {n}", needs=("name", "is"), form=FORM)
        found.append(
            Quantity(
                name=str(one["name"]),
                formula=str(one["is"]),
                tolerance=_tolerance(one.get("tolerance", tolerance), f"quantity {one['name']!r}: tolerance"),
                expect=str(one.get("expect", "")),
                scale=str(one.get("scale", "")),
                condition=str(one.get("if", "")),
                order=float(one.get("order", 2.0)),
            )
        )
    given_names = [one.name for one in found]
    twice = next((one for one in given_names if given_names.count(one) > 1), None)
    if twice is not None:
        raise SceneError(f"quantity must have a name of its own (got {twice!r} twice)")
    return tuple(found)


def _look(campaign: Campaign) -> None:
    """Refuse names of parameters and quantities that there are none of, before anything is run."""
    study = campaign.models[0].study
    parameters = [one.name for one in study.parameters]
    for axis in ("x", "y"):
        name = campaign.drawn.get(axis)
        if name is not None and name not in parameters:
            raise SceneError(
                f"map.{axis} must be one of {', '.join(parameters)} (got {name!r}){nearest(str(name), parameters)}"
            )
    known = [one.name for one in campaign.quantities]
    for name in campaign.drawn.get("quantities", []) if known else []:
        if name not in known:
            raise SceneError(f"map.quantities must be some of {', '.join(known)} (got {name!r}){nearest(name, known)}")
    for row in study.rows:
        for quantity in (None, *campaign.quantities):
            campaign.claimed(study.names(row, coarse=False), quantity)
