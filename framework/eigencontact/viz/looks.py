"""Looks of figures: for the screen, for a column of a paper, for a talk. Nothing here changes global settings."""

from __future__ import annotations

from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from eigencontact.errors import SceneError, nearest, shown

if TYPE_CHECKING:
    from collections.abc import Iterator

__all__ = ["COLOURS", "LOOKS", "Look", "are_shown", "figure_look", "look_of", "shown_figures", "used_look"]

#: Colour-blind-safe line colours (Okabe and Ito): blue, vermilion, green, orange, purple, sky.
COLOURS = ("#0072B2", "#D55E00", "#009E73", "#E69F00", "#CC79A7", "#56B4E9")
#: Width of a column of a paper [inch]: 8.4 cm.
COLUMN = 8.4 / 2.54
#: Width of both columns of a paper [inch]: 17 cm.
BOTH_COLUMNS = 17.0 / 2.54
#: Width of the pictures of the screen [inch].
PAGE = 5.8
#: Figures of the screen that are wider [inch] have two panels beside each other.
TWO_PANELS = 6.3
#: Labels take a larger part of a narrow figure: it is made higher by this factor, and what stays empty is cut off.
ROOM = 1.15

_SCREEN: dict[str, Any] = {
    "font.size": 9,
    "axes.titlesize": 9.5,
    "figure.titlesize": 9.5,
    "figure.titleweight": "normal",
    "axes.labelsize": 9,
    "axes.linewidth": 0.7,
    "axes.spines.top": True,
    "axes.spines.right": True,
    "axes.formatter.useoffset": False,
    "legend.fontsize": 8,
    "legend.frameon": False,
    "lines.linewidth": 1.2,
    "lines.markersize": 3.2,
    "xtick.direction": "in",
    "ytick.direction": "in",
    "xtick.top": True,
    "ytick.right": True,
    "xtick.major.pad": 5.5,  # a label at the corner stays clear of that of the other axis
    "xtick.labelsize": 8.5,
    "ytick.labelsize": 8.5,
    "image.interpolation": "nearest",
    "mathtext.default": "regular",
    "savefig.facecolor": "white",
    "pdf.fonttype": 42,  # text stays text, which journals and drawing programs read
    "svg.hashsalt": "eigencontact",  # the same picture is the same file
}
_PAPER = {
    **_SCREEN,
    **dict.fromkeys(("font.size", "axes.titlesize", "figure.titlesize", "axes.labelsize"), 8),
    **dict.fromkeys(("xtick.labelsize", "ytick.labelsize", "legend.fontsize"), 7),
    "axes.linewidth": 0.5,
    "lines.linewidth": 0.8,
    "lines.markersize": 2.2,
    "xtick.major.width": 0.5,
    "ytick.major.width": 0.5,
    "xtick.major.size": 2.5,
    "ytick.major.size": 2.5,
    "xtick.major.pad": 4.0,
}
_TALK = {
    **_SCREEN,
    **dict.fromkeys(("font.size", "axes.titlesize", "figure.titlesize", "axes.labelsize"), 16),
    **dict.fromkeys(("xtick.labelsize", "ytick.labelsize", "legend.fontsize"), 14),
    "axes.linewidth": 1.2,
    "lines.linewidth": 2.4,
    "lines.markersize": 6.0,
    "xtick.major.width": 1.2,
    "ytick.major.width": 1.2,
    "xtick.major.size": 5.0,
    "ytick.major.size": 5.0,
    "xtick.major.pad": 8.0,
}


@dataclass(frozen=True)
class Look:
    """Sizes, fonts and lines of figures.

    Attributes
    ----------
    name : str
        What a user calls it.
    settings : dict
        Of matplotlib.
    dpi : int
        Resolution of pictures made of dots [dots per inch].
    growth : (float, float)
        Width and height over those on the screen; unused where the width is that of a column.
    column : bool
        Whether figures are as wide as one column of a paper, or as both.
    """

    name: str
    settings: dict[str, Any] = field(repr=False)
    dpi: int = 200
    growth: tuple[float, float] = (1.0, 1.0)
    column: bool = False

    @property
    def page(self) -> float:
        """Width of a picture [inch] without a column."""
        return self.growth[0] * PAGE

    @property
    def compact(self) -> bool:
        """Whether figures are made higher than they need be, and are cut to what they hold."""
        return self.column or self.growth[1] > self.growth[0]

    def size(self, width: float, height: float) -> tuple[float, float]:
        """Width and height [inch] of a figure that has the given ones on the screen.

        Examples
        --------
        >>> [round(2.54 * LOOKS["paper"].size(width, 4.0)[0], 3) for width in (5.8, 6.9)]
        [8.4, 17.0]
        """
        if not self.column:
            return self.growth[0] * min(width, PAGE), self.growth[1] * height
        column_width = COLUMN if width < TWO_PANELS else BOTH_COLUMNS
        return column_width, ROOM * height * column_width / width if column_width < width else height


#: By name; the first is that of runs.
LOOKS = {
    look.name: look
    for look in (
        Look("screen", _SCREEN),
        Look("paper", _PAPER, dpi=600, column=True),
        Look("talk", _TALK, growth=(1.15, 1.4)),
    )
}
_USED: ContextVar[Look] = ContextVar("look of figures", default=LOOKS["screen"])
_SHOWN: ContextVar[bool] = ContextVar("figures of pyplot", default=False)


def look_of(name: str) -> Look:
    """Look of a name.

    Raises
    ------
    SceneError
        Names the nearest one.
    """
    if name not in LOOKS:
        names = ", ".join(map(repr, LOOKS))
        raise SceneError(f"style must be one of {names} (got {shown(name)}){nearest(str(name), LOOKS)}")
    return LOOKS[name]


def used_look() -> Look:
    """Look in use."""
    return _USED.get()


@contextmanager
def shown_figures() -> Iterator[None]:
    """Create figures in this block by pyplot, for notebooks and windows."""
    token = _SHOWN.set(True)
    try:
        yield
    finally:
        _SHOWN.reset(token)


def are_shown() -> bool:
    """Whether figures are made by pyplot."""
    return _SHOWN.get()


@contextmanager
def figure_look(look: Look | None = None) -> Iterator[None]:
    """Settings of figures, for the block only; figures that are made in it have this look, by default that in use."""
    import matplotlib as mpl
    from cycler import cycler

    look = look or _USED.get()
    token = _USED.set(look)
    try:
        with mpl.rc_context({**look.settings, "axes.prop_cycle": cycler(color=COLOURS)}):
            yield
    finally:
        _USED.reset(token)
