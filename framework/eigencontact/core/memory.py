"""Memory of this process, and of the machine."""

from __future__ import annotations

import os
import resource
import sys
from pathlib import Path

__all__ = ["largest_child_bytes", "machine_bytes", "peak_bytes", "resident_bytes"]

#: Unit in which the system counts memory [bytes].
_UNIT = 1 if sys.platform == "darwin" else 1024


def resident_bytes() -> float:
    """Present memory of this process; at the start, that of the interpreter and its libraries."""
    try:
        pages = Path("/proc/self/statm").read_text(encoding="ascii").split()[1]
        return float(pages) * resource.getpagesize()
    except OSError:
        return float(peak_bytes())


def peak_bytes() -> int:
    """Largest memory of this process so far [bytes]."""
    try:
        lines = Path("/proc/self/status").read_text(encoding="ascii").splitlines()
        return next(1024 * int(line.split()[1]) for line in lines if line.startswith("VmHWM"))
    except (OSError, StopIteration):
        return _UNIT * int(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss)


def largest_child_bytes() -> int:
    """Largest memory of the finished child processes."""
    return _UNIT * int(resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss)


def machine_bytes() -> float:
    """Memory of this machine [bytes]; a tebibyte if the system does not report it."""
    try:
        return float(os.sysconf("SC_PHYS_PAGES")) * os.sysconf("SC_PAGE_SIZE")
    except (AttributeError, ValueError, OSError):
        return float(2**40)
