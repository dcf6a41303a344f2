"""Looks of figures, for the screen, a column of a paper, a talk; titles and legends inside the width of their figure.

Nothing here changes global settings.
"""

from __future__ import annotations

from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from eigencontact.errors import SceneError, nearest, shown

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from matplotlib.text import Text

__all__ = [
    "COLOURS",
    "LOOKS",
    "Look",
    "are_shown",
    "broken",
    "figure_look",
    "finish",
    "fit_titles",
    "legend_below",
    "look_of",
    "shown_figures",
    "used_look",
]

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

#: Where a line of a title is broken, the first of them that it holds: what comes before stays, what follows goes on.
BREAKS = ((";  ", ""), (" (", "("), (", ", ""), (" at ", "at "), (" by ", "by "), (" ", ""))
#: Room beside a title, in parts of the size of letters.
_ROOM = 0.3
#: Room beside an entry of a legend, in parts of the size of letters.
_HANDLE = 4.6
#: Room above and below what a figure holds [inch].
_MARGIN = 0.05
#: Lines are broken so many times at most.
_MOST = 4

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


def _resized(
    letters: float, small: float, axes: float, lines: float, markers: float, ticks: tuple[float, float], pad: float
) -> dict[str, Any]:
    """Settings of the screen in other sizes [points]: letters, lines, and width and length of ticks."""
    return {
        **_SCREEN,
        **dict.fromkeys(("font.size", "axes.titlesize", "figure.titlesize", "axes.labelsize"), letters),
        **dict.fromkeys(("xtick.labelsize", "ytick.labelsize", "legend.fontsize"), small),
        "axes.linewidth": axes,
        "lines.linewidth": lines,
        "lines.markersize": markers,
        **dict.fromkeys(("xtick.major.width", "ytick.major.width"), ticks[0]),
        **dict.fromkeys(("xtick.major.size", "ytick.major.size"), ticks[1]),
        "xtick.major.pad": pad,
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
        """Whether figures are drawn with extra height and cropped to their content."""
        return self.column or self.growth[1] > self.growth[0]

    def size(self, width: float, height: float) -> tuple[float, float]:
        """Width and height [inch] of a figure with a given size on the screen.

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
        Look("paper", _resized(8, 7, 0.5, 0.8, 2.2, (0.5, 2.5), 4.0), dpi=600, column=True),
        Look("talk", _resized(16, 14, 1.2, 2.4, 6.0, (1.2, 5.0), 8.0), growth=(1.15, 1.4)),
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
    """Settings of figures within the block; figures made in it have this look, by default the present one."""
    import matplotlib as mpl
    from cycler import cycler

    look = look or _USED.get()
    token = _USED.set(look)
    try:
        with mpl.rc_context({**look.settings, "axes.prop_cycle": cycler(color=COLOURS)}):
            yield
    finally:
        _USED.reset(token)


def finish(figure: Figure) -> None:
    """Lay out a figure: titles within its width, and in a column of a paper without empty height."""
    engine = figure.get_layout_engine()
    if engine is None:
        return
    engine.execute(figure)
    if fit_titles(figure):
        engine.execute(figure)
    if used_look().compact:
        for _ in range(2):  # a lower figure is laid out anew
            height = figure.get_tightbbox(_renderer(figure)).height + 2 * _MARGIN
            figure.set_figheight(min(height, figure.get_figheight()))
            engine.execute(figure)


def fit_titles(figure: Figure) -> bool:
    """Break titles wider than the figure, after its layout; returns whether one was broken."""
    renderer = _renderer(figure)
    panels = [axes for axes in figure.axes if axes.get_title()]
    titles: list[tuple[Text, float, float]] = [(axes.title, *_room_for(axes, panels)) for axes in panels]
    above = getattr(figure, "_suptitle", None)
    titles += [] if above is None else [(above, 0.0, float(figure.bbox.width))]
    changed = False
    for title, left, right in titles:
        room = _ROOM * float(title.get_fontsize()) * figure.dpi / 72
        for _ in range(_MOST):
            box = title.get_window_extent(renderer)
            if box.x0 >= left + room and box.x1 <= right - room:
                break
            text = broken(title.get_text())
            if text == title.get_text():
                break
            title.set_text(text)
            changed = True
    return changed


def _room_for(axes: Axes, panels: list[Axes]) -> tuple[float, float]:
    """Left and right end of the space of a title: the figure's, or half of the gap to a neighbouring panel."""
    title_box = axes.get_window_extent()
    boxes = [panel.get_window_extent() for panel in panels if panel is not axes]
    before = [0.5 * (box.x1 + title_box.x0) for box in boxes if box.x1 <= title_box.x0]
    after = [0.5 * (box.x0 + title_box.x1) for box in boxes if box.x0 >= title_box.x1]
    return max([0.0, *before]), min([float(axes.figure.bbox.width), *after])


def _renderer(figure: Figure) -> Any:
    """Renderer that measures texts; a new one for figures of other backends."""
    from matplotlib.backends.backend_agg import RendererAgg

    canvas: Any = figure.canvas
    if hasattr(canvas, "get_renderer"):
        return canvas.get_renderer()
    return RendererAgg(figure.bbox.width, figure.bbox.height, figure.dpi)


def broken(text: str) -> str:
    """Text with its longest line broken in two; unchanged where this line has no place to break.

    Examples
    --------
    >>> broken("Von Mises stress at 650 mN (step 3 of 9)").splitlines()
    ['Von Mises stress at 650 mN', '(step 3 of 9)']
    """
    lines = text.split("\n")
    longest = max(range(len(lines)), key=lambda n: len(lines[n]))
    line = lines[longest]
    for mark, prefix in BREAKS:
        places = [n for n in range(len(line)) if line.startswith(mark, n)]
        if places:
            at = min(places, key=lambda n: abs(n - len(line) / 2))
            first, tail = line[:at], prefix + line[at + len(mark) :]
            lines[longest] = f"{first}{',' if mark == ', ' else ''}\n{tail}"
            return "\n".join(lines)
    return text


def legend_below(figure: Any, handles: Sequence[Any], labels: Sequence[str], most: int) -> None:
    """Legend below all panels, in as many columns as the width of the figure has room for, at most so many."""
    import matplotlib as mpl
    from matplotlib.font_manager import FontProperties
    from matplotlib.textpath import TextPath

    font = FontProperties(size=mpl.rcParams["legend.fontsize"])
    size = font.get_size_in_points()
    wide = [TextPath((0, 0), label, prop=font).get_extents().width + _HANDLE * size for label in labels]
    room = 72 * float(figure.bbox.width) / float(figure.dpi)
    count = min(most, len(labels))
    while count > 1 and sum(float(max(column)) for column in np.array_split(wide, count)) > room:
        count -= 1
    figure.legend(handles, labels, loc="outside lower center", ncols=count)
