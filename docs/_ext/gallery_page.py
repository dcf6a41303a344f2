"""The page of one bundled scene: description, links, pictures with captions, and, folded, its file and its output."""

from __future__ import annotations

import json
import re
import tomllib
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from scene_uses import plugin_target, plugins_of

from eigencontact.scene.loader import bundled_names, bundled_text

#: Lines of the file and of the output that a page shows at most.
LONGEST = 120
#: Number of a case in a description, which only the scene's tests need.
CASE = re.compile(r"^Case [A-Z]+(-\d+)?(: ?| )|,? ?\bcase [A-Z]+-\d+(: )?")
#: Tables whose keys every scene uses; links to them say nothing about the scene.
COMMON = ("title", "description", "name", "output")
#: Names of pictures begin so; the first that a run has stands for it in the index.
TELLING = ("worn", "damage", "section", "shear.", "uplift.", "pressure.")


def pictures_of(folder: Path) -> list[str]:
    """Names of the pictures of a run, the most telling first."""
    names = sorted(path.name for path in folder.glob("*.png") if not path.name.startswith("small-"))
    ranks = {name: rank for rank, word in enumerate(TELLING) for name in names if name.startswith(word)}
    return sorted(names, key=lambda name: (ranks.get(name, len(TELLING)), name))


def prose(text: str) -> str:
    """Text of a scene as Markdown, without the number of its case; quoted names of scenes become links."""
    stripped = text.strip()
    without_case = CASE.sub("", stripped)
    if without_case != stripped:
        without_case = without_case[:1].upper() + without_case[1:]
    escaped = re.sub(r"([*_<>$\\`\[\]#|])", r"\\\1", without_case)
    scenes = set(bundled_names())
    return re.sub(
        r"'([a-z0-9-]+)'", lambda hit: f"[{hit[1]}]({hit[1]}.md)" if hit[1] in scenes else f"`{hit[1]}`", escaped
    )


def scene_page(name: str, scene: Mapping[str, Any], folder: Path) -> str:
    """Markdown of the page of a scene."""
    run = json.loads((folder / "run.json").read_text("utf-8"))
    animations = sorted(path.name for path in folder.glob("*.gif"))
    title = prose(scene.get("title", name))
    return (
        "\n\n".join(
            [
                f"# {title}",
                prose(scene.get("description", "")),
                (
                    f"`eigencontact run {name}` took {run['seconds']:.1f} s with its pictures, while another run was "
                    f"active. `eigencontact gallery show {name} > my.toml` copies the scene."
                ),
                *_links(scene),
                "::::{grid} 1 1 2 2\n:gutter: 3\n:class-container: gallery-pictures",
                *(
                    _figure(name, file, title, run["captions"].get(file, ""), wide=file in animations)
                    for file in (*animations, *pictures_of(folder))
                ),
                "::::",
                *_folded(
                    "Scene file", "toml", _without_description(bundled_text(name)), f"eigencontact gallery show {name}"
                ),
                *_folded("Output on the terminal", "text", run["output"], f"eigencontact run {name}"),
            ]
        )
        + "\n"
    )


def _links(scene: Mapping[str, Any]) -> Iterator[str]:
    tables = [key for key, value in scene.items() if key not in COMMON and isinstance(value, dict | list)]
    keys = ", ".join(f"[`{key}`](../reference/scene.md#{key})" for key in tables)
    plugins = ", ".join(f"{{ref}}`{key} <{plugin_target(kind, key)}>` ({kind})" for kind, key in plugins_of(scene))
    yield f"**Keys:** {keys}" + (f"  \n**Plugins:** {plugins}" if plugins else "")


def _figure(name: str, file: str, title: str, caption: str, *, wide: bool) -> str:
    columns = ":columns: 12\n" if wide else ""
    words = re.sub(r"([*_<>$\\`\[\]#|])", r"\\\1", caption)
    figure = f"```{{figure}} pictures/{name}/{file}\n:alt: {title}, {Path(file).stem}\n\n{words}\n```"
    return f":::{{grid-item}}\n{columns}\n{figure}\n:::"


def _without_description(text: str) -> str:
    """The file without the description, which stands at the top of the page."""
    description = tomllib.loads(text).get("description")
    if description is None:
        return text
    return re.sub(r'^description = (?:"""[\s\S]*?"""|".*")\n', "", text, flags=re.MULTILINE)


def _folded(heading: str, language: str, text: str, command: str) -> Iterator[str]:
    lines = text.strip().splitlines()
    shown = "\n".join(lines[:LONGEST])
    yield (
        f":::{{dropdown}} {heading}\n```{{code-block}} {language}\n:class: no-search\n\n{shown}\n```"
        + (f"\nThe first {LONGEST} of {len(lines)} lines; `{command}` prints all." if len(lines) > LONGEST else "")
        + "\n:::"
    )
