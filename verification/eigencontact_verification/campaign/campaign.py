"""A campaign as its file tells it: models, the reference that judges them, quantities, and where agreement is claimed.

The scene, its constants and what is varied are those of a study, so that a campaign is read as one: a study of the
model, and where another semi-analytical model judges, three studies of the reference, which differ in the constant that
is refined.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from math import isclose
from pathlib import Path
from typing import Any

from eigencontact.errors import SceneError, shown
from eigencontact_verification.campaign.form import FORM, JUDGES, SHARED
from eigencontact_verification.reporting.bundled import read_toml
from eigencontact_verification.studies.catalogue import Catalogue
from eigencontact_verification.studies.errors import with_errors
from eigencontact_verification.studies.form import as_tables, checked, one_of
from eigencontact_verification.studies.formula import Context, evaluate
from eigencontact_verification.studies.study import Study, study_of

__all__ = ["CAMPAIGNS", "Campaign", "Model", "Quantity", "read_campaign"]

#: Parts by which the ratios of both refinements may differ: cells come in whole numbers.
_RATIOS = 0.15


@dataclass(frozen=True, kw_only=True)
class Quantity:
    """A quantity of model and reference; see the table ``quantity`` of `FORM`. Empty texts are the defaults."""

    name: str  #: name in tables
    formula: str
    tolerance: float  #: largest error that is agreement, a part of the scale
    expect: str = ""
    scale: str = ""
    condition: str = ""
    order: float = 2.0  #: largest order of convergence that is believed


@dataclass(frozen=True, kw_only=True)
class Model:
    """A scene of a campaign with its variants, and its reference."""

    study: Study  #: study of the model
    reference: tuple[Study, ...] = ()  #: studies of the reference, coarse to fine; empty where finite elements judge


@dataclass(frozen=True, kw_only=True)
class Campaign:
    """A model, the reference that judges it, and the variants for which agreement is claimed."""

    name: str  #: name on the command line
    title: str  #: the question
    trend: str  #: known of the answer
    judge: str  #: one of `JUDGES`
    models: tuple[Model, ...]  #: one for each scene
    coarse_models: tuple[Model, ...]  #: those of a first look
    words: str  #: the model, in a few words
    reference: str  #: its judge, in a few words
    quantities: tuple[Quantity, ...]  #: compared with another scene; finite elements compare every field they have
    tolerance: float  #: see `FORM`
    expect: str  #: formula of the variants with a claim of agreement; empty: all
    full_meshes: bool = False  #: whether finite elements take the meshes of a full verification
    #: Whether whole scenes are compared: each then runs in a process of its own, so that its memory is its own.
    whole_scenes: bool = False
    ratio: float = 2.0  #: ratio of the refinements of the reference
    coarse_ratio: float = 2.0  #: the same in a first look
    drawn: Mapping[str, Any] = field(default_factory=dict)  #: table ``map``
    sources: Sequence[Mapping[str, Any]] = ()  #: earlier work on the question

    def with_errors(self) -> Campaign:
        """Campaign whose models, not their references, estimate the errors of their numbers."""
        models, coarse = (
            tuple(replace(model, study=with_errors(model.study)) for model in several)
            for several in (self.models, self.coarse_models)
        )
        return replace(self, models=models, coarse_models=coarse)

    def claimed(self, names: Mapping[str, Any], quantity: Quantity | None = None) -> bool:
        """Whether agreement is claimed for a variant of these constants and parameters."""
        if quantity is not None and quantity.expect:
            return bool(evaluate(quantity.expect, Context(names), f"quantity {quantity.name!r}: expect"))
        return not self.expect or bool(evaluate(self.expect, Context(names), f"{self.name}: expect"))


def read_campaign(path: Path, text: str | None = None) -> Campaign:
    """Read the campaign of a TOML file, or of its text; its name is that of the file.

    Raises
    ------
    SceneError
        A faulty key, with its rule.
    """
    tables = read_toml(path, text, "campaign")
    table = checked(tables, "campaign", f"campaign {path.stem}", needs=("title", "judge"), form=FORM)
    judge = one_of(str(table["judge"]), JUDGES, "judge")
    coarse = checked(table.get("coarse", {}), "coarse", "coarse", form=FORM)
    reference = _reference(table, judge)
    tolerance = _tolerance(table.get("tolerance", 0.02), "tolerance")
    scenes, coarse_scenes = _scenes(table, coarse)
    fine, first = _refined(reference, coarse)
    folder = path.resolve().parent if path.is_file() or text is None else None

    def models(chosen: Sequence[Any], levels: Mapping[str, Sequence[Any]]) -> tuple[Model, ...]:
        def study(scene: Any, refined: Mapping[str, Any] | None = None) -> Study:
            return study_of(_tables_of_study(table, coarse, reference, scene, refined), path.stem, path.parent, folder)

        refinements = [{name: value} for name, values in levels.items() for value in values]
        return tuple(
            Model(study=study(scene), reference=tuple(study(scene, refined) for refined in refinements))
            for scene in chosen
        )

    campaign = Campaign(
        name=path.stem,
        title=str(table["title"]),
        trend=" ".join(str(table.get("trend", "")).split()),
        judge=judge,
        models=models(scenes, fine),
        coarse_models=models(coarse_scenes, first),
        words=str(table.get("model", "the model")),
        reference=str(reference.get("words", JUDGES[judge])),
        quantities=_quantities(table, judge, tolerance),
        tolerance=tolerance,
        expect=str(table.get("expect", "")),
        full_meshes=_meshes(table, judge),
        whole_scenes="scenes" in table,
        ratio=_ratio(fine),
        coarse_ratio=_ratio(first),
        drawn=checked(table.get("map", {}), "map", "map", form=FORM),
        sources=[checked(source, "source", "source") for source in as_tables(table.get("source", []))],
    )
    _refuse_unknown_names(campaign)
    return campaign


#: Bundled campaigns, and those of a user.
CAMPAIGNS: Catalogue[Campaign] = Catalogue("campaign", "campaign", read_campaign)


def _tolerance(value: Any, place: str) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float) or not 0.0 < value < 1.0:
        raise SceneError(f"{place} must be between 0 and 1 (got {shown(value)}); 0.02 is two per cent of the quantity")
    return float(value)


def _reference(table: Mapping[str, Any], judge: str) -> Mapping[str, Any]:
    for key in ("reference", "quantity"):
        if judge != "scene" and key in table:
            raise SceneError(f"{key} must be used with judge = 'scene' (got judge = {judge!r}); remove it")
        if judge == "scene" and key not in table:
            raise SceneError(f"campaign must have {key} with judge = 'scene': {FORM['campaign'][key]}")
    if judge != "scene":
        return {}
    return checked(table["reference"], "reference", "reference", needs=("refine",), form=FORM)


def _meshes(table: Mapping[str, Any], judge: str) -> bool:
    """Whether finite elements take full meshes."""
    meshes = one_of(table.get("meshes", "quick"), ("quick", "full"), "meshes")
    if judge == "scene" and "meshes" in table:
        raise SceneError("meshes must be used with judge = 'audit' or 'contact' (got judge = 'scene'); remove it")
    return meshes == "full"


def _scenes(table: Mapping[str, Any], coarse: Mapping[str, Any]) -> tuple[list[Any], list[Any]]:
    """Scenes of the campaign, and those of a first look."""
    if ("scene" in table) == ("scenes" in table):
        raise SceneError("campaign must have either scene or scenes (got both or none)")
    if "scene" in table:
        return [table["scene"]], [table["scene"]]
    several = table["scenes"]
    if not isinstance(several, list) or not several or not all(isinstance(scene, str) for scene in several):
        raise SceneError(f"scenes must be an array of bundled scenes or files (got {shown(several)})")
    return several, [
        one_of(scene, several, "coarse.scenes", rule="some of scenes") for scene in coarse.get("scenes", several)
    ]


def _refined(
    reference: Mapping[str, Any], coarse: Mapping[str, Any]
) -> tuple[dict[str, list[Any]], dict[str, list[Any]]]:
    """Constant that is refined with its values; and with those of a first look."""
    if not reference:
        return {}, {}
    fine = _levels(reference["refine"], "reference.refine")
    first = _levels(coarse.get("refine", reference["refine"]), "coarse.refine")
    return fine, first


def _levels(levels: Any, place: str) -> dict[str, list[Any]]:
    if not isinstance(levels, Mapping) or len(levels) != 1:
        raise SceneError(f"{place} must be a table with one constant and its three values (got {shown(levels)})")
    ((name, values),) = levels.items()
    numbers = values if isinstance(values, list) else []
    if len(numbers) != 3 or not all(isinstance(number, int | float) and number > 0 for number in numbers):
        raise SceneError(f"{place}.{name} must be three positive numbers, coarse to fine (got {shown(values)})")
    first, second = numbers[1] / numbers[0], numbers[2] / numbers[1]
    if not (max(first, 1 / first) > 1.1 and isclose(first, second, rel_tol=_RATIOS)):
        raise SceneError(
            f"{place}.{name} must go from coarse to fine by one ratio above 1.1 (got {first:.3g} and {second:.3g})"
        )
    return {str(name): list(numbers)}


def _ratio(levels: Mapping[str, Sequence[float]]) -> float:
    """Size of elements of a level over that of the next finer one, by their geometric mean."""
    for values in levels.values():
        ratio = (values[2] / values[0]) ** 0.5
        return float(max(ratio, 1.0 / ratio))
    return 2.0


def _tables_of_study(
    table: Mapping[str, Any], coarse: Mapping[str, Any], reference: Mapping[str, Any], scene: Any,
    refined: Mapping[str, Any] | None,
) -> dict[str, Any]:  # fmt: skip
    """Tables of the study of the model, or of a refinement of the reference: a constant and its value."""
    tables = {key: table[key] for key in SHARED if key in table} | {"scene": scene}
    first = {key: coarse[key] for key in ("constants", "vary", "set") if key in coarse}
    if "scenes" in table:
        label = Path(str(scene)).stem
        tables["vary"] = [{"scene": [label], **varied} for varied in as_tables(tables.get("vary", {}))]
        if "vary" in first:
            first["vary"] = [{"scene": [label], **varied} for varied in as_tables(first["vary"])]
    if refined is not None:
        for constants in (tables, first):
            constants["constants"] = {**constants.get("constants", {}), **refined}
        always = {"if": "1", **{key: reference[key] for key in ("set", "without") if key in reference}}
        tables["when"] = [*as_tables(tables.get("when", [])), always, *as_tables(reference.get("when", []))]
    return {**tables, "coarse": first}


def _quantities(table: Mapping[str, Any], judge: str, tolerance: float) -> tuple[Quantity, ...]:
    quantities: list[Quantity] = []
    for n, item in enumerate(as_tables(table["quantity"]) if judge == "scene" else []):
        keys = checked(item, "quantity", f"quantity {n}", needs=("name", "is"), form=FORM)
        name = str(keys["name"])
        if name in [quantity.name for quantity in quantities]:
            raise SceneError(f"quantity names must be different (got {name!r} twice)")
        quantities.append(
            Quantity(
                name=name,
                formula=str(keys["is"]),
                tolerance=_tolerance(keys.get("tolerance", tolerance), f"quantity {name!r}: tolerance"),
                expect=str(keys.get("expect", "")),
                scale=str(keys.get("scale", "")),
                condition=str(keys.get("if", "")),
                order=float(keys.get("order", 2.0)),
            )
        )
    return tuple(quantities)


def _refuse_unknown_names(campaign: Campaign) -> None:
    """Refuse unknown parameters and quantities before anything runs."""
    study = campaign.models[0].study
    for axis in ("x", "y"):
        if axis in campaign.drawn:
            one_of(campaign.drawn[axis], [parameter.name for parameter in study.parameters], f"map.{axis}")
    quantity_names = [quantity.name for quantity in campaign.quantities]
    for name in campaign.drawn.get("quantities", []) if quantity_names else []:
        one_of(name, quantity_names, "map.quantities", rule=f"some of {', '.join(quantity_names)}")
    for row in study.rows:
        for quantity in (None, *campaign.quantities):
            campaign.claimed(study.names(row, coarse=False), quantity)
