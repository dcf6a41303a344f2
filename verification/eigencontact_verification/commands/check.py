"""The command `eigencontact check`; this module imports little, because the help of `eigencontact` loads it."""

from __future__ import annotations

import json
import shutil
import textwrap
from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Annotated, Any

import typer

if TYPE_CHECKING:
    from eigencontact.hooks.registry import Entry

__all__ = ["check"]


def check(
    plugins: Annotated[
        list[str], typer.Argument(help="Plugin files, or keys of installed plugins.", metavar="FILE|KEY...")
    ],
    *,
    parameters: Annotated[
        list[str] | None,
        typer.Option("--with", metavar="KEY=VALUE", help="A parameter: `--with radius='1 mm'`; repeatable."),
    ] = None,
    finite_elements: Annotated[
        bool, typer.Option("--finite-elements", help="Also run the slow check of a shape: 10 s to 2 min.")
    ] = False,
    as_json: Annotated[bool, typer.Option("--json", help="Print JSON instead of text.")] = False,
) -> None:
    """Check plugins against the contract of their kind: interface, shapes, units, derivatives, symmetries.

    The parameters are those of the class attribute `example`, changed by `--with`; of a shape that has none, lengths
    are tried.

    Exit codes: 0 all promises are kept, 1 some are not, 2 wrong input.

    Examples: `eigencontact check torus.py`, `eigencontact check j2 --with hardening.yield-stress="300 MPa"`
    """
    from eigencontact.errors import EigencontactError

    try:
        verdicts_by_key = {
            entry.full_key: list(_verdicts(entry, parameters or [], finite_elements=finite_elements))
            for entry in _entries(plugins)
        }
    except (EigencontactError, ValueError) as problem:
        typer.echo(f"eigencontact: {' '.join(str(problem).split())}", err=True)
        raise typer.Exit(2) from None
    if as_json:
        typer.echo(json.dumps(verdicts_by_key, indent=2))
    else:
        _print(verdicts_by_key)
    raise typer.Exit(
        1 if any(verdict["failed"] for verdicts in verdicts_by_key.values() for verdict in verdicts) else 0
    )


def _entries(plugins: list[str]) -> list[Entry]:
    """Components to check; files are registered in this process first."""
    from eigencontact.errors import PluginError
    from eigencontact.scene.installed import add_plugin_files, installed_plugins

    files = [name for name in plugins if name.endswith(".py")]
    before = {entry.component for entry in installed_plugins()}
    add_plugin_files(files)
    registry = installed_plugins()
    entries = [entry for entry in registry if entry.component not in before]
    for key in plugins:
        named = [] if key in files else registry.named(key)
        if not named and key not in files:
            raise PluginError(registry.unknown(key))
        entries += named
    return entries


def _verdicts(entry: Entry, parameters: list[str], *, finite_elements: bool) -> Iterator[dict[str, str]]:
    from eigencontact_verification.conformance.kit import checks_for
    from eigencontact_verification.conformance.report import ConformanceError

    component = _example(entry, parameters)
    for conformance_check in checks_for(component, finite_elements=finite_elements):
        try:
            conformance_check(component)
            failed = ""
        except ConformanceError as problem:
            failed = " ".join(str(problem).split())
        promise = (conformance_check.__doc__ or "").strip().split("\n")[0]
        yield {"check": conformance_check.__name__, "promise": promise, "failed": failed}


def _example(entry: Entry, parameters: list[str]) -> Any:
    """Component to check: of the declared example, of lengths that are tried, or of nothing but defaults."""
    from dataclasses import MISSING, fields

    from eigencontact.library.components import make
    from eigencontact.scene.loader import apply_changes
    from eigencontact_verification.crosscheck.strangers import example_of

    declared = getattr(entry.component, "example", None)
    if not isinstance(declared, Mapping) and entry.kind == "inclusion-shape" and not parameters:
        declared = example_of(entry.component)
    parameters_of_example = apply_changes(
        declared if isinstance(declared, Mapping) else {}, parameters, option="--with"
    )
    needed = [
        item.name for item in fields(entry.component) if item.default is MISSING and item.default_factory is MISSING
    ]
    if needed and not parameters_of_example:
        raise ValueError(
            f"{entry.kind} {entry.key!r} must have parameters for the check (got none); give --with "
            f"{needed[0]}=VALUE, or give its class an attribute example, a mapping with {', '.join(needed)}"
        )
    return make(entry.full_key, kind=entry.kind, **parameters_of_example)


def _print(verdicts_by_key: dict[str, list[dict[str, str]]]) -> None:
    """Print one line a promise, cut to the width of the terminal; failures in full."""
    columns = shutil.get_terminal_size().columns
    for name, verdicts in verdicts_by_key.items():
        width = max(len(verdict["check"]) for verdict in verdicts)
        typer.echo(name)
        for verdict in verdicts:
            promise = textwrap.shorten(verdict["promise"], max(40, columns - width - 11), placeholder=" …")
            typer.echo(f"  {'FAILS' if verdict['failed'] else 'kept '}  {verdict['check']:<{width}}  {promise}")
            if verdict["failed"]:
                typer.echo(f"         {verdict['failed'].partition(': ')[2]}")
        broken = sum(1 for verdict in verdicts if verdict["failed"])
        typer.echo(f"  {len(verdicts) - broken} of {len(verdicts)} promises kept")
