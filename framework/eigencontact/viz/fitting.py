"""Layout of titles above their axes and of legends inside the width of their figure."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from eigencontact.viz.looks import used_look

if TYPE_CHECKING:
    from collections.abc import Sequence

    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from matplotlib.text import Text

__all__ = ["broken", "finish", "fit_titles", "legend_below"]

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


def finish(figure: Figure) -> None:
    """Lay a figure out: titles inside its width, and in a column of a paper no higher than what it holds."""
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
    """Break titles that reach beyond the figure, once its layout is known; whether one was broken."""
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
    """Left and right end of the room for a title: the figure's, or half the way to a panel beside."""
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
