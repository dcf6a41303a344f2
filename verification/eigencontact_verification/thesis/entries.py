"""Entries of the index of the thesis: figures and tables, their claims, and the rule that judges a claim."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from eigencontact.errors import SceneError, nearest

__all__ = ["DRAWN", "KINDS", "SIDES", "TAKES", "Claim", "Entry", "Erratum", "Index", "Rule"]

#: Kinds of figures and tables; `DRAWN` show no result of the method and end there.
KINDS = ("sketch", "photograph", "list", "curve", "map", "table")
DRAWN = KINDS[:3]
#: How a rule makes one number, or a yes or no, of the rows of a study.
TAKES = ("at", "ratio", "difference", "max", "min", "place-of-max", "spread", "rising", "falling")
#: On which side of the value of the text the number must lie.
SIDES = ("about", "above", "below")


@dataclass(frozen=True, kw_only=True)
class Rule:
    """Number, or trend, that judges a claim: of the rows of a study, or of a formula of constants or of a scene."""

    study: str = ""  #: study whose rows are read
    read: str = ""  #: name of a number of the study
    per: str = ""  #: number of the same row by which it is divided
    take: str = "at"  #: one of `TAKES`
    #: Parameters of the rows; a list allows several values, "none" no value.
    at: Mapping[str, Any] = field(default_factory=dict)
    over: Mapping[str, Any] = field(default_factory=dict)  #: parameters of the row that a ratio or difference refers to
    along: str = ""  #: parameter of a trend or of a place
    full: bool = False  #: whether its variants run at full size in the quick form too, whose cells are too few for it
    formula: str = ""  #: formula of `constants` instead of a study
    scene: str = ""  #: bundled scene whose results the formula reads
    constants: Mapping[str, float] = field(default_factory=dict)  #: numbers of the formula, as the text gives them

    def __post_init__(self) -> None:
        _one_of(self.take, TAKES, "rule.take")
        _must(bool(self.study) != bool(self.formula), "rule", "name a study or a formula, not both", self.study)
        _must(not self.study or bool(self.read), "rule.read", "name a number of the study", self.read)
        _must(self.take not in ("ratio", "difference") or bool(self.over), "rule.over", "name a row", self.over)
        trend = self.take in ("rising", "falling", "place-of-max")
        _must(not trend or bool(self.along), "rule.along", f"name a parameter for {self.take}", self.along)


@dataclass(frozen=True, kw_only=True)
class Claim:
    """A statement of the text about a figure, in other words than the text's."""

    says: str  #: the statement
    value: float | None = None  #: number of the text; None for a trend
    unit: str = "1"
    tolerance: float = 0.0  #: relative width of agreement
    side: str = "about"  #: one of `SIDES`
    rule: Rule | None = None  #: what judges it; None leaves it open
    right: Sequence[float] = ()  #: bounds of the right number, where the text is wrong
    erratum: str = ""  #: why the text is wrong, and what shows it
    differs: str = ""  #: why the result of this program is another one by design or resolution
    incomparable: str = ""  #: why nothing can be compared
    lacks: str = ""  #: what an open claim needs

    def __post_init__(self) -> None:
        _one_of(self.side, SIDES, "claim.side")
        _must(self.tolerance >= 0, "claim.tolerance", "not be negative", self.tolerance)
        _must(not self.right or len(self.right) == 2, "claim.right", "be two bounds", self.right)
        _must(not self.right or bool(self.erratum), "claim.erratum", "say why the text is wrong", self.says)
        reasons = [self.erratum, self.differs, self.incomparable]
        _must(sum(map(bool, reasons)) < 2, "claim", "have one reason of erratum, differs, incomparable", self.says)
        judged = self.rule is not None or bool(self.incomparable) or bool(self.lacks)
        _must(judged, "claim.lacks", "say what a claim without rule needs", self.says)
        trend = self.rule is not None and self.rule.take in ("rising", "falling")
        if self.rule is not None:
            _must(trend == (self.value is None), "claim.value", "be given unless the rule is a trend", self.says)

    @property
    def bounds(self) -> tuple[float, float]:
        """Bounds of agreement with the text."""
        assert self.value is not None
        width = abs(self.value) * self.tolerance
        low = float("-inf") if self.side == "below" else self.value - width
        return low, float("inf") if self.side == "above" else self.value + width


@dataclass(frozen=True, kw_only=True)
class Entry:
    """A numbered figure or table."""

    number: str  #: as 3.20
    kind: str  #: one of `KINDS`
    place: str  #: section
    shows: str  #: content
    study: str = ""  #: study that computes it
    panel: int = 0  #: number of the panel of the study's figure that shows it best
    only: str = ""  #: formula of parameters: which variants of the study its picture shows
    scene: str = ""  #: bundled scene that computes it, or a case of it
    test: str = ""  #: file of a test that computes it
    parameters: str = ""  #: constants, with their section
    lacks: str = ""  #: what keeps it from being computed
    scan: bool = True  #: whether the scan has its caption
    claim: Sequence[Claim] = ()

    def __post_init__(self) -> None:
        _one_of(self.kind, KINDS, f"{self.number} kind")
        drawn = self.kind in DRAWN
        by = bool(self.study or self.scene or self.test)
        _must(not (drawn and by), f"{self.number} kind", "be a result if a study computes it", self.kind)
        _must(drawn or by or bool(self.lacks), f"{self.number} lacks", "say what keeps it from being computed", "")

    @property
    def name(self) -> str:
        """Number of a figure; of a table with that word, as both count from 1."""
        return f"table {self.number}" if self.kind in ("list", "table") else self.number

    @property
    def chapter(self) -> int:
        """Number of its chapter."""
        return int(self.number.partition(".")[0])

    @property
    def state(self) -> str:
        """Whether it is computed, open, or shows no result."""
        if self.kind in DRAWN:
            return "no result"
        return "computed" if self.study or self.scene or self.test else "open"


@dataclass(frozen=True, kw_only=True)
class Erratum:
    """A formula or a number of the text that is wrong, outside of the claims on figures."""

    place: str  #: equation or section
    wrong: str  #: what is wrong
    right: str  #: what holds


@dataclass(frozen=True, kw_only=True)
class Index:
    """All entries, and the errata of the text."""

    figure: Sequence[Entry]
    table: Sequence[Entry]
    erratum: Sequence[Erratum]

    def entries(self, chapter: int | None = None, number: str | None = None) -> list[Entry]:
        """Entries of a chapter, or of one number; tables after the figures of their chapter.

        Raises
        ------
        SceneError
            No such figure or chapter.
        """
        all_entries = sorted((*self.figure, *self.table), key=lambda entry: entry.chapter)
        entries = [entry for entry in all_entries if chapter in (None, entry.chapter) and number in (None, entry.name)]
        if not entries and number is not None:
            names = [entry.name for entry in all_entries]
            raise SceneError(f"--figure must be one of the thesis (got {number!r}){nearest(number, names)}")
        if not entries:
            raise SceneError(f"--chapter must be one of 1, 2, 3, 4 (got {chapter})")
        return entries


def _one_of(value: str, allowed: Sequence[str], where: str) -> None:
    _must(value in allowed, where, f"be one of {', '.join(allowed)}", value)


def _must(holds: object, where: str, rule: str, value: Any) -> None:
    if not holds:
        raise SceneError(f"thesis: {where} must {rule} (got {value!r})")
