"""What the site's pages depend on, as one hash: the code and the bundled scenes."""

from __future__ import annotations

import hashlib
from functools import cache
from pathlib import Path

ROOT = Path(__file__).parents[2]


@cache
def code_hash() -> str:
    """Hash of all files of the three packages."""
    total = hashlib.sha256()
    for folder in ("framework", "plugins", "verification"):
        for path in sorted((ROOT / folder).rglob("*")):
            if path.suffix in {".py", ".toml", ".npz", ".txt"} and path.is_file():
                total.update(path.relative_to(ROOT).as_posix().encode() + b"\0" + path.read_bytes())
    return total.hexdigest()
