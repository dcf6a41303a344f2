"""A study: a scene, parameters that vary, numbers of each variant, a figure, and the publication of the trend."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import product
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from eigencontact.core.units import NUMBER
from eigencontact.errors import SceneError, shown
from eigencontact_verification.reporting.bundled import read_toml
from eigencontact_verification.studies.errors import Errors, error_of
from eigencontact_verification.studies.form import as_tables, checked, one_of
from eigencontact_verification.studies.formula import Context, evaluate
from eigencontact_verification.studies.template import changed, filled

if TYPE_CHECKING:
    import xarray as xr

    from eigencontact.scene.schema import Scene

__all__ = [
    "Finished",
    "Parameter",
    "Study",
    "formatted",
    "label_of",
    "levels_of",
    "number_of",
    "plain",
    "read_study",
    "study_of",
]

Values = Mapping[str, Any]


@dataclass(frozen=True)
class Parameter:
    """A parameter that varies."""

    name: str  #: name in formulas
    key: str = ""  #: dotted key of the scene that takes its values; empty where only formulas use them
    label: str = ""


@dataclass(frozen=True, kw_only=True)
class Study:
    """A scene, its variants, numbers and figure; see the tables of `eigencontact_verification.studies.form.FORM`."""

    name: str  #: name on the command line
    title: str  #: the question
    trend: str = ""  #: known outcome, and its limits
    sources: Sequence[Mapping[str, Any]] = ()  #: publications of the trend
    scene_tables: Mapping[str, Any]  #: scene, with formulas
    constants: Values  #: numbers by name
    coarse_constants: Values  #: those of a first look
    parameters: Sequence[Parameter]
    rows: Sequence[Values]  #: values of the parameters of each variant, in the order of the figure
    coarse_rows: Sequence[Values]  #: those of a first look
    changes: Mapping[str, Any] = field(default_factory=dict)  #: values at keys of the scene
    coarse_changes: Mapping[str, Any] = field(default_factory=dict)  #: those of a first look
    cases: Sequence[Mapping[str, Any]] = ()  #: changes for some variants
    label: str = ""  #: text of a variant
    #: Name in formulas, formula, and condition of each number.
    readings: Mapping[str, tuple[str, str, str]] = field(default_factory=dict)
    figure: Mapping[str, Any] = field(default_factory=dict)  #: ``size``, ``columns``, ``legend`` and ``panel``
    checks: Sequence[Mapping[str, Any]] = ()  #: statements that the trend must satisfy
    folder: Path | None = None  #: folder of the files that the scene names

    def names(self, values: Values, *, coarse: bool) -> dict[str, Any]:
        """Constants, and parameters of a variant."""
        return {**(self.coarse_constants if coarse else self.constants), **values}

    def scene(self, values: Values, *, coarse: bool) -> Scene:
        """Scene of some values; coarse for a first look: fewer cells and steps."""
        from eigencontact.scene.schema import Scene

        context = Context(self.names(values, coarse=coarse))
        put = {
            parameter.key: values[parameter.name]
            for parameter in self.parameters
            if parameter.key and parameter.name in values
        }
        tables = changed(self.scene_tables, {**self.changes, **put})
        for case in self.cases:
            if bool(evaluate(case["if"], context, f"{self.name}: when.if")):
                tables = changed(tables, case.get("set", {}), case.get("without", ()))
        if coarse:
            tables = changed(tables, self.coarse_changes)
        return Scene(**filled(tables, context, self.name)).within(self.folder)

    def text(self, values: Values) -> str:
        """Label of a variant."""
        if self.label:
            return formatted(self.label, values)
        return ", ".join(
            f"{parameter.label} = {plain(values[parameter.name])}"
            for parameter in self.parameters
            if parameter.name in values
        )

    def read(self, values: Values, dataset: xr.Dataset, *, coarse: bool = False) -> dict[str, float]:
        """Numbers of a finished variant, by name; those that its results do not have are left out."""
        names, numbers = self.names(values, coarse=coarse), dict[str, float]()
        symbols = [symbol for symbol, *_ in self.readings.values()]
        twice = next((name for name in (*names, *symbols) if name in dataset.variables), None)
        if twice is not None:
            raise SceneError(f"{self.name}: names must not be names of results (got {twice!r}); choose another name")
        for label, (symbol, formula, condition) in self.readings.items():
            if condition and not bool(evaluate(condition, Context(names, dataset), f"{self.name}: read.{label}.if")):
                continue
            number = float(np.asarray(evaluate(formula, Context(names, dataset), f"{self.name}: read.{label}")))
            numbers[label] = names[symbol] = number
        return numbers

    def errors_of(
        self, values: Values, dataset: xr.Dataset, row: Mapping[str, float], bars: Errors, *, coarse: bool = False
    ) -> dict[str, float | None]:
        """Errors of the numbers of results and of the readings in a row, by their names in formulas."""
        names, errors = self.names(values, coarse=coarse), dict(bars)
        for label, (symbol, formula, _) in self.readings.items() if bars else ():
            if label in row:
                error = error_of(formula, Context(names, dataset), errors)
                names[symbol], errors[symbol] = row[label], None if error is None else float(error)
        return errors

    def row_errors(self, variant: Finished) -> dict[str, float]:
        """Errors of the numbers in the row of a variant; those that are exact or not known are left out."""
        symbols = {name: symbol for name, (symbol, *_) in self.readings.items() if name in variant.row}
        return {name: error for name, symbol in symbols.items() if (error := variant.errors.get(symbol))}


@dataclass(frozen=True)
class Finished:
    """A variant with its results."""

    label: str
    values: Values  #: its parameters
    dataset: xr.Dataset
    row: Mapping[str, float]  #: numbers of the results, by name
    names: Mapping[str, Any]  #: names of formulas: constants, parameters, numbers
    place: int = 0  #: its number in the order of the study
    warnings: Sequence[Mapping[str, Any]] = ()  #: warnings of the run, as in ``summary.json``
    #: Errors of numbers and readings by their names in formulas; empty for a run without error bars.
    errors: Errors = field(default_factory=dict)

    @property
    def context(self) -> Context:
        """Context of formulas."""
        return Context(self.names, self.dataset)


def read_study(path: Path, text: str | None = None) -> Study:
    """Read the study of a TOML file, or of its text; its name is that of the file.

    Raises
    ------
    SceneError
        A faulty key, with its rule.
    """
    tables = read_toml(path, text, "study")
    return study_of(tables, path.stem, path.parent, path.resolve().parent if path.is_file() else None)


def study_of(tables: Mapping[str, Any], name: str, beside: Path, folder: Path | None = None) -> Study:
    """Study of the tables of its file.

    Parameters
    ----------
    beside : Path
        Folder of scenes that it names.
    folder : Path, optional
        Folder of the files that the scene names.

    Raises
    ------
    SceneError
        A faulty key, with its rule.
    """
    table = checked(tables, "study", f"study {name}", needs=("title", "scene", "vary"))
    coarse = checked(table.get("coarse", {}), "coarse", "coarse")
    groups = as_tables(table["vary"])
    parameters: dict[str, Parameter] = {}
    constants = _numbers(table.get("constants", {}))
    blocks = [_block(group, parameters, constants) for group in groups]
    coarser = _numbers({**table.get("constants", {}), **coarse.get("constants", {})})
    coarse_blocks = [_block({**group, **less}, parameters, coarser)
           for group, less in zip(groups, _fewer(coarse, len(groups)), strict=True) if less is not None]  # fmt: skip
    return Study(
        name=name,
        title=str(table["title"]),
        trend=" ".join(str(table.get("trend", "")).split()),
        sources=[checked(less, "source", "source") for less in as_tables(table.get("source", []))],
        scene_tables=_scene(table["scene"], beside),
        constants=constants,
        coarse_constants=coarser,
        parameters=list(parameters.values()),
        rows=[row for block in blocks for row in block],
        coarse_rows=[row for block in coarse_blocks for row in block],
        changes=table.get("set", {}),
        coarse_changes=coarse.get("set", {}),
        cases=[checked(less, "when", "when", needs=("if",)) for less in as_tables(table.get("when", []))],
        label=str(table.get("label", "")),
        readings=_readings(table.get("read", {})),
        figure=_figure(table),
        checks=[checked(less, "check", "check", needs=("number", "is")) for less in as_tables(table.get("check", []))],
        folder=folder,
    )


def _fewer(coarse: Mapping[str, Any], count: int) -> list[Mapping[str, Any] | None]:
    """Changes of each product of values for a first look; None leaves it out."""
    if "vary" not in coarse:
        return [{}] * count
    products = as_tables(coarse["vary"])
    return [*products, *[None] * (count - len(products))]


def _numbers(tables: Mapping[str, Any]) -> dict[str, Any]:
    numbers: dict[str, Any] = {}
    for name, value in tables.items():
        numbers[name] = evaluate(value, Context(numbers), f"constants.{name}") if isinstance(value, str) else value
    return numbers


def _block(group: Any, parameters: dict[str, Parameter], constants: Values) -> list[dict[str, Any]]:
    """Rows of each value of the first parameter with each of the second, and so on; the last changes fastest."""
    from eigencontact.sweeps.axes import axes_of

    if not isinstance(group, Mapping) or not group:
        raise SceneError(f"vary must be a table of parameters and their values (got {shown(group)})")
    columns: dict[str, list[Any]] = {}
    for name, content in group.items():
        table = checked(content, "vary", f"vary.{name}") if isinstance(content, Mapping) else {"values": content}
        key = str(table.get("key", "" if name.isidentifier() else name))
        label = str(table.get("label", parameters[name].label if name in parameters else name))
        parameters[name] = Parameter(name, key or (parameters[name].key if name in parameters else ""), label)
        values = table.get("values", {word: table[word] for word in ("from", "to", "count", "log") if word in table})
        if isinstance(values, str):
            values = [float(value) for value in np.ravel(evaluate(values, Context(constants), f"vary.{name}"))]
        columns[name] = list(axes_of({name: values})[0].values)
    return [dict(zip(columns, row, strict=True)) for row in product(*columns.values())]


def _scene(value: Any, folder: Path) -> Mapping[str, Any]:
    from eigencontact.app import load_scene

    if isinstance(value, Mapping):
        return value
    beside = folder / str(value)
    loaded = load_scene(beside if beside.is_file() else value)
    return loaded.resolved()


def _readings(formulas: Any) -> dict[str, tuple[str, str, str]]:
    if not isinstance(formulas, Mapping):
        raise SceneError(f"read must be a table of formulas (got {shown(formulas)})")
    readings = {}
    for name, reading in formulas.items():
        table = (
            {"is": reading} if isinstance(reading, str) else checked(reading, "read", f"read.{name!r}", needs=("is",))
        )
        readings[str(name)] = (str(table.get("as", name)), str(table["is"]), str(table.get("if", "")))
    return readings


def _figure(table: Mapping[str, Any]) -> dict[str, Any]:
    figure = dict(checked(table.get("figure", {}), "figure", "figure"))
    panels = []
    for n, table_of_panel in enumerate(as_tables(table.get("panel", []))):
        panel = dict(checked(table_of_panel, "panel", f"panel {n}"))
        curves = as_tables(panel.get("curve", []))
        panel["curve"] = [checked(curve, "curve", f"panel {n}, curve", needs=("x", "y")) for curve in curves]
        if "map" in panel:
            panel["map"] = checked(panel["map"], "map", f"panel {n}, map", needs=("x", "y", "z"))
        panels.append(panel)
    one_of(figure.get("legend", "right"), ("right", "above", "none"), "figure.legend")
    return {**figure, "panel": panels}


def label_of(parameters: Iterable[Parameter], name: str) -> str:
    """Label of a parameter, or the name where there is no such parameter."""
    return next((parameter.label for parameter in parameters if parameter.name == name), name)


def levels_of(rows: Iterable[Values], name: str) -> list[Any]:
    """Values of a parameter in several rows, each once; sorted where all are numbers."""
    levels = list(dict.fromkeys(row[name] for row in rows if name in row))
    numbers = all(isinstance(number_of(level), int | float) for level in levels)
    return sorted(levels, key=number_of) if numbers else levels


def formatted(label: str, values: Values) -> str:
    """Text with parameters in braces.

    Raises
    ------
    SceneError
        Braces that name no parameter.
    """
    try:
        return label.format_map(values)
    except (KeyError, ValueError, IndexError) as problem:
        raise SceneError(f"label must name parameters in braces (got {label!r}): {problem}") from None


def plain(value: Any) -> str:
    """Value of a parameter as text."""
    return f"{value:g}" if isinstance(value, float) else str(value)


def number_of(value: Any) -> Any:
    """Number at the beginning of a text, so that texts with units have an order."""
    match = NUMBER.match(value) if isinstance(value, str) else None
    return float(match[0]) if match else value
