"""Pages that are made before the site is read: the gallery, the keys of scenes, the plugins, the commands."""

from __future__ import annotations

import subprocess
from collections import defaultdict
from collections.abc import Collection, Mapping
from pathlib import Path
from typing import Any

from api import api_pages
from click import Context
from gallery import write, write_gallery
from scene_uses import plugin_target, scenes_by_plugin
from sphinx.application import Sphinx
from sphinx.config import Config
from thesis_page import thesis_tables
from typer.main import get_command

from eigencontact.cli import app as command_line
from eigencontact.listing import plugin_data
from eigencontact.reference.numbers import numbers_as_markdown
from eigencontact.reference.tables import all_tables
from eigencontact.reference.text import as_markdown
from eigencontact.reports.citations import citations
from eigencontact.scene.installed import installed_plugins
from eigencontact.scene.loader import bundled_names


def _scene_page(docs: Path) -> None:
    text = as_markdown(all_tables(installed_plugins()).values())
    lead = (
        "# Keys of a scene\n\nEvery table and key that a scene may hold, as the program itself knows them. "
        "`eigencontact schema TABLE` prints a part of this page; `eigencontact schema --json` writes a JSON Schema, "
        "by which editors of TOML complete and check keys. The parameters of what `type` names are on the page of "
        "[plugins](plugins.md).\n\n"
    )
    write(docs / "reference" / "scene.md", lead + text)


def _cell(text: Any) -> str:
    return str(text).replace("``", "`").replace("|", "\\|").replace("\n", " ")


def _key_table(keys: list[dict[str, Any]]) -> str:
    rows = ["| key | takes | default | meaning |", "|---|---|---|---|"]
    for key in keys:
        default = "*required*" if key["required"] else "" if key["default"] in (None, "", []) else f"`{key['default']}`"
        rows.append(f"| `{key['name']}` | {_cell(key['takes'])} | {_cell(default)} | {_cell(key['meaning'])} |")
    return "\n".join(rows)


def _plugin_pages(docs: Path, scenes: Collection[str]) -> None:
    """A page for each kind of plugin, and one that lists all plugins."""
    kinds = defaultdict(list)
    for entry in plugin_data(installed_plugins())["plugins"]:
        kinds[entry["kind"]].append(entry)
    rows = ["| kind | plugins |", "|---|---|"]
    for kind, entries in kinds.items():
        links = ", ".join(f"{{ref}}`{entry['type']} <{plugin_target(kind, entry['type'])}>`" for entry in entries)
        rows.append(f"| [{kind}](plugins-{kind}.md) | {links} |")
        page = [f"# {kind.replace('-', ' ').capitalize()}: plugins"]
        page += [_plugin_section(kind, entry, scenes) for entry in entries]
        write(docs / "reference" / f"plugins-{kind}.md", "\n\n".join(page) + "\n")
    lead = (
        "# Plugins\n\nValues of `type` in each table. `eigencontact plugins KEY` prints the parameters and sources "
        "of one plugin, also of your own packages. [Write a plugin](../plugins/index.md) shows how to add one.\n\n"
    )
    contents = "\n\n```{toctree}\n:hidden:\n\n" + "\n".join(f"plugins-{kind}" for kind in kinds) + "\n```\n"
    write(docs / "reference" / "plugins.md", lead + "\n".join(rows) + contents)


def _plugin_section(kind: str, entry: Mapping[str, Any], scenes: Collection[str]) -> str:
    parts = [f"({plugin_target(kind, entry['type'])})=\n## {entry['type']}", _cell(entry["summary"])]
    if entry["parameters"]:
        parts.append(_key_table(entry["parameters"]))
    for name, keys in entry["tables"].items():
        parts += [f"In each table of `{name}`:", _key_table(keys)]
    if entry["references"]:
        parts.append("Sources: " + "; ".join(map(_cell, entry["references"])) + ".")
    if users := scenes_by_plugin().get((kind, entry["type"])):
        links = (f"[{name}](../gallery/{name}.md)" if name in scenes else f"`{name}`" for name in users)
        parts.append("In the gallery: " + ", ".join(links) + ".")
    return "\n\n".join(parts)


def _bibliography_page(docs: Path) -> None:
    users = defaultdict(list)
    for entry in plugin_data(installed_plugins())["plugins"]:
        for reference in entry["references"]:
            users[reference].append((entry["kind"], entry["type"]))
    lines = [
        "# Bibliography",
        (
            "Sources of the plugins, as each plugin names them. A run stores the sources that it used, and its report "
            "has them as BibTeX. The pages of the [theory](../theory/index.md) name the sources of the solvers."
        ),
    ]
    cited = sorted(citations(list(users)), key=lambda source: source.text.lstrip("ABCDEFGHIJKLMNOPQRSTUVWXYZ. "))
    for source in cited:
        doi = f"[doi:{source.doi}](<https://doi.org/{source.doi}>)" if source.doi else ""
        plugins = ", ".join(
            f"{{ref}}`{key} <{plugin_target(kind, key)}>`" for kind, key in dict.fromkeys(users[source.text])
        )
        lines.append(f"- {_cell(source.before)}{doi}{_cell(source.after)} ({plugins})")
    write(docs / "reference" / "bibliography.md", "\n\n".join(lines[:2]) + "\n\n" + "\n".join(lines[2:]) + "\n")


def _command_page(docs: Path) -> None:
    parts = ["# Commands", "What `eigencontact --help` and the help of each command say."]
    group = get_command(command_line)
    for words in ((), *((name,) for name in group.list_commands(Context(group)))):
        command = ["eigencontact", *words, "--help"]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        if done.returncode:
            raise RuntimeError(f"command {words} must have a help (got: {done.stderr.strip()})")
        parts += [f"## {' '.join(words) or 'eigencontact'}", f"```text\n{done.stdout.strip()}\n```"]
    write(docs / "reference" / "commands.md", "\n\n".join(parts) + "\n")


def _number_page(docs: Path) -> None:
    lead = (
        "# Numbers of a run\n\nEvery scalar that a step may have, with its unit. A scene gives those of the blocks it "
        "needs; laws and observers add their own. `results.nc` holds the values of all steps, `summary.json` one "
        "value for the run. A *certificate* measures how well the equations of a step are met, an *error* estimates "
        "what a result may be off by, an *effort* counts work.\n\n"
    )
    write(docs / "reference" / "numbers.md", lead + numbers_as_markdown(installed_plugins()) + "\n")


def _generate(app: Sphinx, config: Config) -> None:
    docs = Path(app.srcdir)
    chosen = [name for name in config.gallery_scenes.split(",") if name]
    _scene_page(docs)
    _plugin_pages(docs, chosen or bundled_names())
    _bibliography_page(docs)
    _number_page(docs)
    _command_page(docs)
    for name, text in api_pages():
        write(docs / "api" / "generated" / f"{name}.md", text)
    write_gallery(docs, chosen)
    # included by a page; shows pictures of the gallery
    write(docs / "reference" / "thesis.txt", thesis_tables(docs / "measured" / "thesis.json"))


def setup(app: Sphinx) -> dict[str, bool]:
    app.add_config_value("gallery_scenes", "", "env", str)  # a few, while a page is being written
    app.connect("config-inited", _generate)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
