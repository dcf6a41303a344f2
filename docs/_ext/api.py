"""Pages of the library: names of the package and of `eigencontact.plugin`, then its modules by package."""

from __future__ import annotations

import importlib
import inspect
import pkgutil
from collections.abc import Iterator
from types import GenericAlias

PACKAGES = {
    "eigencontact.solvers": "Solvers",
    "eigencontact.convolution": "Convolution",
    "eigencontact.halfspace": "Half-space kernels",
    "eigencontact.core": "Core",
    "eigencontact.results": "Results",
    "eigencontact_verification.conformance": "Conformance kit",
    "eigencontact_verification.oracles": "Oracles",
}


def api_pages() -> Iterator[tuple[str, str]]:
    """Name and text of each page."""
    for module in ("eigencontact", "eigencontact.plugin"):
        yield module, _names(module, f"The package {module}")
    for package, title in PACKAGES.items():
        yield package, _modules(package, title)


def _names(name: str, title: str) -> str:
    module = importlib.import_module(name)
    things = {thing: getattr(module, thing) for thing in module.__all__}
    lines = [f"# {title}", f"Names of `{name}`: documented, tested, stable.", "| name | what it is |\n|---|---|"]
    elsewhere = set(importlib.import_module("eigencontact").__all__)
    for thing, value in things.items():
        page = "eigencontact" if thing in elsewhere else name
        lines[-1] += f"\n| {{py:obj}}`{thing} <{page}.{thing}>` | {_first(value)} |"
    for thing, value in things.items():
        if (name != "eigencontact" and thing in elsewhere) or isinstance(value, GenericAlias):
            continue
        kind = "class" if _is_class(value) else "function" if inspect.isroutine(value) else "data"
        option = "\n   :members:" if kind == "class" else "\n   :no-value:" if kind == "data" else ""
        lines.append(f"```{{eval-rst}}\n.. auto{kind}:: {name}.{thing}{option}\n```")
    return "\n\n".join(lines) + "\n"


def _is_class(value: object) -> bool:
    return inspect.isclass(value) and not isinstance(value, GenericAlias)


def _first(value: object) -> str:
    if not (_is_class(value) or inspect.isroutine(value)):
        return ""
    return (inspect.getdoc(value) or "").split("\n")[0].replace("``", "`").replace("|", "\\|")


def _modules(package: str, title: str) -> str:
    root = importlib.import_module(package)
    lines = [f"# {title}", f"{(inspect.getdoc(root) or '').strip()}", "What is listed here works, and may change."]
    for found in pkgutil.walk_packages(root.__path__, f"{package}."):
        module = importlib.import_module(found.name)
        if getattr(module, "__all__", ()):
            lines.append(f"## {found.name.removeprefix(package + '.')}")
            lines.append(f"```{{eval-rst}}\n.. automodule:: {found.name}\n   :members:\n```")
    return "\n\n".join(lines) + "\n"
