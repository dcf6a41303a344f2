"""Provenance that results store: scene, versions, references, and a hash of everything that decides the numbers."""

from __future__ import annotations

import hashlib
import json
import platform
from collections.abc import Iterator
from dataclasses import asdict
from functools import cache
from importlib.metadata import PackageNotFoundError, version
from itertools import accumulate
from typing import Any

import numpy as np

from eigencontact.model.sources import Source
from eigencontact.planning.plan import Plan
from eigencontact.results.ownership import RESULTS
from eigencontact.results.records import RunInfo
from eigencontact.scene.schema import Scene
from eigencontact.scene.steps import ramps_of, segments_of

__all__ = ["run_info"]

#: Regions that results describe one by one: of more, the first.
_MOST = 1000


def run_info(plan: Plan) -> RunInfo:
    """Provenance of a run, the same for all its steps."""
    import tomli_w

    from eigencontact.core.material import contact_modulus
    from eigencontact.model.bodies import layered_bodies, without_layers
    from eigencontact.model.words import layers_as_data
    from eigencontact.planning.explain import plan_words, references
    from eigencontact.plugin import LayeredMedium

    model, solids, borders = plan.model, plan.model.bodies.solids, dict[str, Any]()
    if model.sources:
        from eigencontact.model.outlines import outlines
        from eigencontact.planning.borders import line_borders, sections_of

        sections = sections_of(model, model.sources[:_MOST])
        borders = {"outlines": outlines(model), "sections": sections, "lines": line_borders(model)}
    resolved = plan.scene.resolved()
    homogeneous = model.interface is not None and not layered_bodies(solids)
    return RunInfo(
        title=plan.scene.title,
        name=plan.name,
        grid=plan.grid,
        scene_toml=tomli_w.dumps(resolved),
        scene_hash=_digest(plan, resolved),
        versions=_versions(plan),
        references=references(plan),
        precisions={choice.operator: choice.chosen for choice in plan.precisions},
        contact_modulus=contact_modulus(*without_layers(solids)) if homogeneous else None,
        steps=plan.steps,
        inclusions=tuple(_inclusion(source) for source in model.sources[:_MOST]),
        **borders,
        layers={
            str(number): layers_as_data(body)
            for number, body in enumerate(solids, 1)
            if isinstance(body, LayeredMedium)
        },
        exposed=() if model.exposed is None else model.exposed.names,
        cycles=tuple(_cycles(plan.scene)),
        sliding=_sliding(plan.scene),
        prestrained=_prestrained(plan.scene),
        numbers=plan.numbers,
        observed=plan.observed,
        every_history=plan.scene.output.history == "all",
        plan=asdict(plan_words(plan)),
    )


def _inclusion(source: Source) -> dict[str, Any]:
    """Description of a region in the results."""
    return {
        "name": source.name,
        "plugin": source.key,
        "body": source.body,
        "bounds": [[float(at) for at in corner] for corner in source.shape.bounds],
        "material": source.material,
    }


def _cycles(scene: Scene) -> Iterator[tuple[float, int, int]]:
    """Position in the load history, ramps and number of repeats of each table of cycles."""
    begin = 0
    for segment in segments_of(scene.steps):
        if segment.cycle:
            yield float(begin), segment.ramps, segment.repeat
        begin += segment.ramps * segment.repeat


def _sliding(scene: Scene) -> tuple[float, ...]:
    """Path [m] before the first ramp of the load history and at the end of each."""
    paths = [ramp.sliding_distance or 0.0 for ramp in ramps_of(scene.steps)]
    return tuple(accumulate(paths, initial=0.0)) if any(paths) else ()


def _prestrained(scene: Scene) -> bool:
    """Whether a scene has an eigenstrain, or an initial state from an earlier run."""
    tables: list[object] = [*scene.eigenstrain, *(item.eigenstrain for item in scene.inclusions)]
    return any([*tables, scene.body1.initial, scene.body2.initial])


def _digest(plan: Plan, resolved: dict[str, Any]) -> str:
    """Hash of the scene, of all its files, and of the packages of its plugins."""
    digest = hashlib.sha256(json.dumps(resolved, sort_keys=True).encode())
    if plan.model.interface is not None:
        y, x = plan.grid.axes()
        # Another surface is another scene.
        digest.update(plan.model.interface.separation(x, y).tobytes())
    for source_file in plan.model.files:
        path = source_file / RESULTS if source_file.is_dir() else source_file  # of an earlier run
        if path.is_file():
            with path.open("rb") as file:
                digest.update(hashlib.file_digest(file, "sha256").digest())
    for component in plan.model.components:
        entry = plan.model.registry.entry_of(component)
        digest.update(b"" if entry.bundled else entry.full_key.encode())  # one plain key may mean another package later
    return digest.hexdigest()


def _versions(plan: Plan) -> dict[str, str]:
    import scipy

    from eigencontact import __version__

    versions = {
        "python": platform.python_version(),
        "numpy": np.__version__,
        "scipy": scipy.__version__,
        "eigencontact": __version__,
    }
    if pyfftw := _version("pyfftw"):
        versions["pyfftw"] = pyfftw
    registry = plan.model.registry
    for component in plan.model.components:
        entry = registry.entry_of(component)
        versions[f"plugin {entry.kind} {registry.spelling(entry)}"] = entry.origin
    return versions


@cache
def _version(package: str) -> str:
    """Version of an installed package, read from its metadata once; nothing where it is not installed."""
    try:
        return version(package)
    except PackageNotFoundError:
        return ""
