"""HTML page from a template, its style and script. All texts of a scene are escaped."""

from __future__ import annotations

from base64 import b64encode
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

from jinja2 import Environment, FileSystemLoader, StrictUndefined
from markupsafe import Markup

from eigencontact import __version__
from eigencontact.core.units import readable
from eigencontact.results.records import FACT_NAME

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

__all__ = ["page"]

_TEMPLATES = Path(__file__).parent / "templates"


def page(template: str, scene: str, content: Mapping[str, Any]) -> str:
    """Fill a template, ``report.html`` or ``sweep.html``, with a scene (TOML) and the content of the template."""
    text = (
        _environment()
        .get_template(template)
        .render(
            **content,
            version=__version__,
            style=_template_markup("style.css"),
            script=_template_markup("surface.js"),
            scene_marked=_highlighted(scene),
            scene_url=f"data:text/plain;charset=utf-8;base64,{b64encode(scene.encode()).decode()}",
        )
    )
    return text if text.endswith("\n") else f"{text}\n"


@cache
def _environment() -> Environment:
    environment = Environment(
        loader=FileSystemLoader(_TEMPLATES), autoescape=True, undefined=StrictUndefined, trim_blocks=True,
        lstrip_blocks=True,
    )  # fmt: skip
    environment.filters |= {"readable": readable, "facts": _facts}
    return environment


def _template_markup(name: str) -> Markup:
    """Read a file of the templates as markup, without escaping."""
    return Markup((_TEMPLATES / name).read_text(encoding="utf-8"))  # noqa: S704


def _highlighted(text: str) -> Markup:
    """TOML with the colours of the style sheet; the highlighter escapes its text."""
    from pygments import highlight
    from pygments.formatters import HtmlFormatter
    from pygments.lexers import TOMLLexer

    return Markup(highlight(text, TOMLLexer(), HtmlFormatter(nowrap=True, classprefix="t-")))  # noqa: S704


def _facts(lines: Sequence[str]) -> list[tuple[str, list[str]]]:
    """Lines of a plan as names and texts."""
    facts: list[tuple[str, list[str]]] = []
    for line in lines:
        name, words = line[:FACT_NAME].strip(), line[FACT_NAME:]
        if name or not facts:
            facts.append((name, [words]))
        else:
            facts[-1][1].append(words)
    return facts
