"""Common parts of commands: groups in the help, flags without a value, shared options, error messages."""

from __future__ import annotations

from contextlib import contextmanager
from typing import TYPE_CHECKING, Annotated, Any

import typer
from typer.core import TyperCommand, TyperGroup

if TYPE_CHECKING:
    from collections.abc import Iterator

__all__ = [
    "PANELS",
    "HelpfulCommand",
    "HelpfulGroup",
    "JsonOption",
    "QuietOption",
    "panel_of",
    "refusals",
]

JsonOption = Annotated[bool, typer.Option("--json", help="Print JSON instead of text.")]
QuietOption = Annotated[bool, typer.Option("--quiet", "-q", help="Print nothing but errors.")]

#: Commands by purpose, in the order of the help; commands that other packages add come last.
PANELS = {
    "Scenes": ("gallery", "schema", "explain"),
    "Solve and look": ("run", "plot", "fatigue", "crack", "shakedown", "report"),
    "Vary parameters": ("sweep", "map", "study", "tradeoff"),
    "Verify": ("verify", "campaign", "extremes"),
    "Plugins": ("plugins", "new-plugin", "check"),
    "Housekeeping": ("cache",),
}
_PLUGIN_PANEL = "Commands of other packages"


def panel_of(command: str) -> str:
    """Heading of a command in the help.

    Examples
    --------
    >>> panel_of("verify"), panel_of("my-command")
    ('Verify', 'Commands of other packages')
    """
    return next((panel for panel, names in PANELS.items() if command in names), _PLUGIN_PANEL)


class _Helpful:
    """Command whose flags have no value type in the help, and whose unknown options list the existing ones."""

    def get_params(self, ctx: Any) -> list[Any]:
        """Parameters of the command; a flag takes no value, so that its help shows none."""
        params: list[Any] = super().get_params(ctx)  # type: ignore[misc]
        for param in params:
            if getattr(param, "is_flag", False):
                param.metavar = ""
        return params

    def parse_args(self, ctx: Any, args: list[str]) -> list[str]:
        """Read the arguments; an unknown option without a similar name lists all options."""
        try:
            remaining_args: list[str] = super().parse_args(ctx, args)  # type: ignore[misc]
        except Exception as problem:
            unknown = str(getattr(problem, "option_name", ""))
            if unknown.startswith("-") and hasattr(problem, "possibilities"):
                options = [name for param in self.get_params(ctx) for name in param.opts if name.startswith("--")]
                problem.possibilities = _resembling(unknown, options) or options
            raise
        return remaining_args


def _resembling(unknown: str, options: list[str]) -> list[str]:
    """Options with a name similar to an unknown option, without the leading hyphens."""
    from difflib import get_close_matches

    names = get_close_matches(unknown.lstrip("-"), [option.lstrip("-") for option in options], cutoff=0.6)
    return [f"--{name}" for name in names]


class HelpfulCommand(_Helpful, TyperCommand):
    """A command."""


class HelpfulGroup(_Helpful, TyperGroup):
    """A group of commands."""


@contextmanager
def refusals(joint: str = "; ", interrupted: str = "") -> Iterator[None]:
    """Print an error of the package as one line and exit with its exit code.

    With a sentence for it an interrupt is reported too.
    """
    from eigencontact.errors import EigencontactError

    try:
        yield
    except EigencontactError as problem:
        lines = str(problem).split() if joint.isspace() else str(problem).splitlines()
        typer.echo(f"eigencontact: {joint.join(filter(None, map(str.strip, lines)))}", err=True)
        raise typer.Exit(problem.exit_code) from None
    except KeyboardInterrupt:
        if not interrupted:
            raise
        typer.echo(f"eigencontact: interrupted; {interrupted}", err=True)
        raise typer.Exit(130) from None
