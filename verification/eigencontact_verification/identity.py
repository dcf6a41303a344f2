"""Are the numbers still those of an earlier commit? Every bundled scene against stored norms of all its results.

A change of the house must not change a result. ``identity.json`` was written by this module running on the commit that
it names (the module uses nothing but the public calls, so that it runs there too); the same scenes are run again
and every scalar and field is compared in three numbers of its own. Scenes whose results were changed with intent since
are named under ``younger`` with the commit of their numbers. Scenes in which contact and interior are iterated on are
also run to a tolerance of 1e-10: another way to the same answer differs by the tolerance of the scene.

``python -m eigencontact_verification.identity`` compares and exits with 1 where something differs that
`EXCEPTIONS` does not explain; ``--write COMMIT`` stores what this commit gives.
"""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

__all__ = ["EXCEPTIONS", "compare", "measured", "scenes"]

REFERENCE = Path(__file__).with_name("identity.json")
#: Relative to the size of a variable: where the arithmetic is the same, and at most.
ROUNDING, CLOSE = 1e-12, 1e-9
#: Measures of the work, and residuals, which are rounding: not results.
WORK = (
    "iterations", "convolutions", "seconds", "residual", "rounds", "substeps", "coupling_iterations",
    "inclusion_iterations", "halvings", "warnings",
)  # fmt: skip
#: Iterated between contact and interior: run to this tolerance as well.
TIGHT = "numerics.tolerance=1e-10"
COUPLED = (
    "ellipsoid-under-contact", "inclusion-cluster", "inclusion-under-contact", "prestressed-concrete",
    "rolling-over-inclusion", "two-inclusions", "void-near-surface", "void-under-contact",
)  # fmt: skip
#: Scene, or scene and variable, -> largest relative difference allowed, and the reason.
_PLACE = (np.inf, "the place of a maximum: rounding chooses among its mirror images")
_ZERO = (np.inf, "zero by symmetry, up to the tolerance")
EXCEPTIONS: dict[str, tuple[float, str]] = {
    "rolling-over-inclusion:moment_x": _ZERO,
    "fretting-mode-2:tangential_load": _ZERO,
    "fretting-mode-2:tangential_load_x": _ZERO,
    "fretting-mode-2:tangential_load_y": _ZERO,
    "fretting-mode-2-plastic:tangential_load": _ZERO,
    "fretting-mode-2-plastic:tangential_load_x": _ZERO,
    "fretting-mode-2-plastic:tangential_load_y": _ZERO,
    "coating-worn-through:torsion_moment": _ZERO,
    "plastic-inclusion:plastic_zone_x": _PLACE,
    "plastic-inclusion:plastic_zone_y": _PLACE,
    "coated-fretting:dissipated_energy_max_x": _PLACE,
    "coated-fretting:dissipated_energy_max_y": _PLACE,
}


def scenes() -> Iterator[tuple[str, list[str]]]:
    """Name under which a run is stored, and its changes."""
    from eigencontact.scene.loader import bundled_names

    for name in bundled_names():
        yield name, []
    for name in COUPLED:
        yield f"{name} {TIGHT}", [TIGHT]


def measured(name: str, changes: list[str]) -> dict[str, list[float]]:
    """Largest size, Euclidean norm and a sum with fixed signs of every result of one scene."""
    import eigencontact

    plain = ["output.pictures=false", "output.vtk=false"]
    result = eigencontact.run(eigencontact.load_scene(name.split(" ", 1)[0], [*changes, *plain]))
    norms = {}
    for variable, values in result.dataset.data_vars.items():
        role = str(values.attrs.get("role"))
        if role not in ("field", "scalar", "observed", "region") or any(word in str(variable) for word in WORK):
            continue
        numbers = np.nan_to_num(np.asarray(values, dtype=float)).ravel()
        signs = np.random.default_rng(1).choice([-1.0, 1.0], numbers.size)
        norms[str(variable)] = [float(np.abs(numbers).max()), float(np.linalg.norm(numbers)), float(signs @ numbers)]
    return norms


def compare(current: dict[str, list[float]], reference: dict[str, list[float]]) -> list[tuple[str, float]]:
    """Variables that differ by more than `ROUNDING`, and by how much; a variable that is gone differs by infinity."""
    differences = []
    for variable, before in reference.items():
        size = before[1]
        floor = _rounding(variable, reference)
        if variable not in current:
            differences.append((variable, np.inf))
        elif size > floor or current[variable][1] > floor:
            # The signed sum adds numbers that cancel: it is measured by the norm too.
            change = max(abs(a - b) for a, b in zip(current[variable], before, strict=True)) / max(size, floor)
            if change > ROUNDING:
                differences.append((variable, change))
    return sorted(differences, key=lambda item: -item[1])


def _rounding(variable: str, reference: dict[str, list[float]]) -> float:
    """Norm below which a variable is the rounding of its neighbours: a shear of 1e-7 Pa beside a pressure of 1e9 Pa.

    Moments are measured by the load on an arm of a contact radius.
    """
    stem = "moment" if "moment" in variable else variable.rsplit("_", 1)[0]
    kin = [values[1] for name, values in reference.items() if name.rsplit("_", 1)[0] == stem]
    if stem == "moment":
        kin.append(reference["normal_load"][1] * reference["contact_radius"][1])
    return 1e-9 * max(kin)


def _allowed(name: str, variable: str) -> tuple[float, str]:
    plain = name.split(" ", 1)[0]
    for key in (f"{name}:{variable}", f"{plain}:{variable}", name, plain if name == plain else ""):
        if key in EXCEPTIONS:
            return EXCEPTIONS[key]
    return CLOSE, ""


def main(arguments: list[str] | None = None) -> int:
    """Compare, or write; returns the exit status."""
    parser = argparse.ArgumentParser(prog="identity", description=__doc__)
    parser.add_argument("--write", metavar="COMMIT", help="store what this commit gives, for the scenes named or all")
    parser.add_argument("names", nargs="*", help="scenes; all by default")
    options = parser.parse_args(arguments)
    chosen = [(n, c) for n, c in scenes() if not options.names or n.split(" ", 1)[0] in options.names]
    if options.write:
        stored: dict[str, Any] = {"commit": options.write, "scenes": {}}
        if options.names:  # the other scenes keep their numbers
            stored = json.loads(REFERENCE.read_text(encoding="utf-8"))
            stored.setdefault("younger", {}).update(dict.fromkeys(options.names, options.write))
        for name, changes in chosen:
            stored["scenes"][name] = measured(name, changes)
            print(f"{name}: {len(stored['scenes'][name])} variables", flush=True)
        REFERENCE.write_text(json.dumps(stored, indent=1) + "\n", encoding="utf-8")
        return 0
    reference, wrong = json.loads(REFERENCE.read_text(encoding="utf-8")), 0
    print(f"against commit {reference['commit']}; relative differences above {ROUNDING:.0e}")
    for name, changes in chosen:
        if name not in reference["scenes"]:
            print(f"new      {name}")
            continue
        differing = compare(measured(name, changes), reference["scenes"][name])
        bad = [(variable, change) for variable, change in differing if change > _allowed(name, variable)[0]]
        wrong += len(bad)
        worst = f"largest {differing[0][1]:.1e} ({differing[0][0]})" if differing else "same"
        print(f"{'differs ' if bad else 'ok      '} {name}: {worst}", flush=True)
        for variable, change in bad:
            print(f"           {variable}: {change:.1e}")
        reasons = {_allowed(name, variable)[1] for variable, change in differing if change > CLOSE}
        for reason in sorted(reasons - {""}):
            print(f"           expected: {reason}")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
