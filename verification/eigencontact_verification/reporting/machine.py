"""Facts of the machine that a timing means nothing without; no names of hosts, users or folders."""

from __future__ import annotations

import os
import platform
from datetime import UTC, datetime
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any

__all__ = ["describe", "facts", "installed", "time_and_machine"]


def installed(distribution: str) -> str | None:
    """Version of an installed package, or None."""
    try:
        return version(distribution)
    except PackageNotFoundError:
        return None


def _proc(path: str, key: str) -> str | None:
    """First value of `key` in a colon-separated file of the kernel."""
    try:
        lines = Path(path).read_text(encoding="utf-8").splitlines()
    except OSError:
        return None
    return next((line.split(":", 1)[1].strip() for line in lines if line.startswith(key)), None)


def facts() -> dict[str, str | int | float | None]:
    """Processor, cores, memory, load and versions.

    ``load_average`` is that of the minute before: other work on the machine makes a timing worth less.
    """
    memory = _proc("/proc/meminfo", "MemTotal")
    cores = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count()
    return {
        "cpu": _proc("/proc/cpuinfo", "model name") or platform.processor() or platform.machine(),
        "cores": cores,
        "memory_gb": round(int(memory.split()[0]) * 1024 / 1e9, 1) if memory else None,
        "load_average": round(os.getloadavg()[0], 2) if hasattr(os, "getloadavg") else None,
        "system": platform.system(),
        "python": platform.python_version(),
        **{name: installed(name) for name in ("numpy", "scipy", "pyfftw", "eigencontact")},
    }


def time_and_machine() -> dict[str, Any]:
    """Entries ``made`` and ``machine`` of the JSON of a report."""
    return {"made": datetime.now(UTC).isoformat(timespec="seconds"), "machine": facts()}


def describe(machine: dict[str, str | int | float | None]) -> str:
    """One line of `facts`."""
    packages = [f"{name} {machine[name]}" for name in ("numpy", "scipy", "pyfftw", "eigencontact") if machine.get(name)]
    memory = f", {machine['memory_gb']} GB" if machine.get("memory_gb") else ""
    return (
        f"{machine['cpu']}, {machine['cores']} cores{memory}, {machine['system']}; Python {machine['python']}, "
        f"{', '.join(packages)}; load average before {machine['load_average']}"
    )
