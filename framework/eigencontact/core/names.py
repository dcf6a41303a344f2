"""Rules for names of files, folders and variables: safe names, and names that results reserve."""

from __future__ import annotations

import re
import unicodedata

from eigencontact.core.quantities import QUANTITIES

__all__ = [
    "ANIMATION",
    "FOLDER_RULE",
    "OF_REGIONS",
    "PICTURES",
    "SURFACE",
    "clashes",
    "is_folder_name",
    "to_folder_name",
]

#: Pictures of a run that are not those of a region, without ``.png``.
PICTURES = (
    "pressure",
    "pressure-profiles",
    "uplift",
    "uplift-profiles",
    "shear",
    "shear-profiles",
    "dissipation",
    "exposed-materials",
    "loop",
    "zones",
    "passing",
    "history",
    "plastic-strain",
    "plastic-strain-second",
    "plastic-surfaces",
    "plastic-surfaces-second",
    "damage",
    "damage-second",
    "plastic-history",
    "load-depth",
    "coverage",
    "worn-depth",
    "worn-profiles",
    "worn-coating",
    "wear-history",
    "wear-loops",
)
#: Animation of a run, without its ending.
ANIMATION = "animation"
#: What pictures of a region add to its name.
OF_REGIONS = ("-loaded", "-means")
#: VTK files of the surface begin so.
SURFACE = "surface"
#: What a region's variables add to its name.
_OF_A_REGION = (
    *("x", "y", "z", "point", "outline"),
    *("stress", "strain", "displacement", "von_mises", "tresca", "hydrostatic", "principal"),
)
#: Scalars of a step that end like a variable of a region: ``tilt_x``, ``max_von_mises``.
_SCALARS = ("max", "moment", "shift", "tangential_load", "tilt", "travel")

FOLDER_RULE = (
    "a plain name: letters, digits, '_', '.' and '-', which begins with a letter, a digit or '_', does not end with "
    "'.', and is no device of a system"
)
_FOLDER = re.compile(r"[A-Za-z0-9_](?:[A-Za-z0-9._-]*[A-Za-z0-9_-])?")
_DEVICE = re.compile(r"(?:con|prn|aux|nul|com[0-9]|lpt[0-9])(?:\..*)?", re.IGNORECASE)


def is_folder_name(name: str) -> bool:
    """Whether a name is a valid folder name on every system: ``FOLDER_RULE``.

    Examples
    --------
    >>> [is_folder_name(name) for name in ("hertz", "run-1.5", "..", ".hidden", "-o", "a/b", "con")]
    [True, True, False, False, False, False, False]
    """
    return bool(_FOLDER.fullmatch(name)) and not _DEVICE.fullmatch(name)


def to_folder_name(text: str) -> str:
    """Nearest name that `is_folder_name` accepts; ``scene`` for text without letters and digits.

    Examples
    --------
    >>> to_folder_name("my scene"), to_folder_name("Kugel (2) auf Böden"), to_folder_name("..")
    ('my-scene', 'Kugel-2-auf-Boden', 'scene')
    """
    if is_folder_name(text):
        return text
    plain = unicodedata.normalize("NFKD", text).encode("ascii", "ignore").decode()
    name = re.sub(r"[^A-Za-z0-9._]+", "-", plain).strip("-.")
    return name if is_folder_name(name) else f"scene-{name}".rstrip("-")


def clashes(region: str) -> bool:
    """Whether files or variables of a region have the names of those of the surface, in any case of letters.

    Examples
    --------
    >>> [clashes(name) for name in ("section", "Pressure", "surface", "displacement", "tilt")]
    [False, True, True, True, True]
    """
    name = region.casefold()
    return name in (SURFACE, *PICTURES, *_SCALARS) or any(
        f"{name}_{quantity}" in QUANTITIES for quantity in _OF_A_REGION
    )
