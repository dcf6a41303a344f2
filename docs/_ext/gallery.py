"""The gallery: every bundled scene is run, its pictures are kept, and an index shows one of them for each.

A run is kept under the hash of the scene and of the code, so that a page is never older than what it shows. Runs go two
at a time.
"""

from __future__ import annotations

import hashlib
import json
import shutil
import subprocess
import time
import tomllib
from collections.abc import Mapping
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

from content import code_hash
from gallery_page import pictures_of, prose, scene_page
from PIL import Image, ImageOps
from sphinx.util.display import status_iterator

from eigencontact.scene.loader import bundled_names, bundled_text

GROUPS = {
    "contact": "Normal contact",
    "friction": "Friction",
    "eigenstrain": "Eigenstrain",
    "regions": "Regions of other materials",
    "layers": "Coatings",
    "yielding": "Plasticity and damage",
    "wear": "Wear",
}
#: Size of every thumbnail [pixels]; the picture is fitted into it on white.
THUMBNAIL = (480, 360)
#: Runs at a time.
BESIDE = 2


def write_gallery(docs: Path, chosen: list[str]) -> None:
    """Pages of all bundled scenes, or of those chosen, and their index in ``docs/gallery``."""
    names = chosen or list(bundled_names())
    runs = _runs(names, docs / "_cache" / "gallery")
    pages, pictures = docs / "gallery", docs / "gallery" / "pictures"
    shutil.rmtree(pictures, ignore_errors=True)
    groups: dict[str, list[str]] = {key: [] for key in GROUPS}
    for name, folder in runs.items():
        scene = tomllib.loads(bundled_text(name))
        groups[_group(scene)].append(name)
        shutil.copytree(folder, pictures / name, ignore=shutil.ignore_patterns("*.json"))
        write(pages / f"{name}.md", scene_page(name, scene, folder))
    for stale in set(pages.glob("*.md")) - {pages / f"{name}.md" for name in (*names, "index")}:
        stale.unlink()
    write(pages / "index.md", _index(groups, runs))


def write(path: Path, text: str) -> None:
    """Text of a generated page; untouched if it is the same, so that Sphinx does not read it again."""
    path.parent.mkdir(parents=True, exist_ok=True)
    if not path.exists() or path.read_text("utf-8") != text:
        path.write_text(text, "utf-8")


def _runs(names: list[str], cache: Path) -> dict[str, Path]:
    """Folders of the runs, by scene; those that are not kept are made."""
    cache.mkdir(parents=True, exist_ok=True)
    folders = {name: cache / f"{name}-{_key(name)}" for name in names}
    wanted = {name: folder for name, folder in folders.items() if not (folder / "run.json").exists()}
    with ThreadPoolExecutor(BESIDE) as pool:
        for _ in status_iterator(
            pool.map(_run, wanted, wanted.values()), "bundled scenes ... ", "darkgreen", len(wanted)
        ):
            pass
    for stale in set(cache.iterdir()) - set(folders.values()):
        shutil.rmtree(stale)
    return folders


def _key(name: str) -> str:
    return hashlib.sha256(f"{code_hash()} {bundled_text(name)}".encode()).hexdigest()[:24]


def _run(name: str, folder: Path) -> None:
    """Pictures of a run, its summary, and the time of the whole command."""
    shutil.rmtree(folder, ignore_errors=True)
    work = folder / name
    work.mkdir(parents=True)
    start = time.perf_counter()
    command = ["eigencontact", "run", name, "-o", name, "--set", "output.vtk=false"]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
    if done.returncode:
        raise RuntimeError(f"scene {name} must run (exit code {done.returncode}): {done.stderr.strip()}")
    seconds = time.perf_counter() - start
    for picture in (*work.glob("*.png"), *work.glob("*.gif")):
        shutil.copy(picture, folder)
    for picture in work.glob("*.png"):
        with Image.open(picture) as image:
            ImageOps.pad(image.convert("RGB"), THUMBNAIL, color="white").save(folder / f"small-{picture.name}")
    captions = json.loads((work / "summary.json").read_text("utf-8"))["files"]
    shutil.rmtree(work)
    record = {"seconds": seconds, "output": done.stdout, "captions": captions}
    (folder / "run.json").write_text(json.dumps(record), "utf-8")


def _group(scene: Mapping[str, Any]) -> str:
    bodies = [scene.get("body1", {}), scene.get("body2", {})]
    regions = [*scene.get("inclusions", ()), *(part for body in bodies for part in body.get("inclusions", ()))]
    materials = [part["material"] for part in regions if "material" in part]
    if "wear" in scene:
        return "wear"
    if any("law" in body for body in bodies) or any(part.get("type") in {"j2", "brittle"} for part in materials):
        return "yielding"
    if any("medium" in body for body in bodies) or "coat" in scene.get("title", "").lower():
        return "layers"
    if materials:
        return "regions"
    if regions or "eigenstrain" in scene:
        return "eigenstrain"
    return "friction" if "friction" in scene else "contact"


def _index(groups: Mapping[str, list[str]], runs: Mapping[str, Path]) -> str:
    lines = [
        "# Gallery",
        (
            "This site runs every bundled scene. `eigencontact gallery show NAME > my.toml` copies a scene as a "
            "starting point for your own; `eigencontact run NAME` runs it as it is."
        ),
    ]
    for key, names in groups.items():
        if not names:
            continue
        lines += [f"## {GROUPS[key]}", "::::{grid} 1 2 3 3\n:gutter: 3"]
        for name in names:
            title = prose(tomllib.loads(bundled_text(name)).get("title", name))
            picture = next(iter(pictures_of(runs[name])), None)
            image = f":img-top: pictures/{name}/small-{picture}\n" if picture else ""
            animated = "\n{bdg-primary}`animation`\n" if any(runs[name].glob("*.gif")) else ""
            card = f":::{{grid-item-card}} {name}\n:link: {name}\n:link-type: doc\n{image}\n{title}\n{animated}:::"
            lines.append(card)
        lines.append("::::")
        lines.append("```{toctree}\n:hidden:\n\n" + "\n".join(names) + "\n```")
    return "\n\n".join(lines) + "\n"
