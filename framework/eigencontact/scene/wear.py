"""Wear table of a scene: law, shares of the bodies, and number of cycles per update of the surfaces."""

from __future__ import annotations

from typing import Annotated, Any, ClassVar, Literal

from pydantic import AfterValidator, model_validator

from eigencontact.scene.checks import at_least, in_range, non_negative
from eigencontact.scene.table import ComponentTable, Table

__all__ = ["Shares", "Wear"]

_Share = Annotated[float, AfterValidator(non_negative("-"))]


class Shares(Table):
    """Shares of the two bodies in the worn depth; their sum is 1.

    Parameters
    ----------
    body1 : float
        Share of body 1 in the worn depth.
    body2 : float
        Share of body 2 in the worn depth.
    """

    body1: _Share = 0.0
    body2: _Share = 0.0

    @model_validator(mode="after")
    def _whole(self) -> Shares:
        total = self.body1 + self.body2
        if abs(total - 1.0) > 1e-12:
            raise ValueError(f"of sum 1 and not {total:g}, as body1 = 0.7, body2 = 0.3")
        return self


class Wear(ComponentTable):
    """Wear of sliding surfaces: ``type`` names the wear law, whose fields are keys of the same table.

    The law computes the worn depth of both bodies together. Each increment of a load step moves the surfaces. Within a
    cycle, the surfaces move at the end of the cycle by the wear of all its increments; with ``update = "increment"``
    each increment moves them.

    The program solves some of the repeated cycles and extrapolates their wear to the cycles between them. The number of
    solved cycles follows from ``jump_error`` or from ``cycles_per_update``. The first two cycles and the last one are
    always solved.

    Attributes
    ----------
    body : {1, 2}, optional
        Body that wears; 1 by default.
    shares : Shares, optional
        Shares of both bodies, if both wear.
    jump_error : float, optional
        Largest relative error of the worn volume by the extrapolation over cycles; 0.01 by default.
    cycles_per_update : int, optional
        Number of cycles for each solved cycle, in place of ``jump_error``.
    layer_error : float
        For worn layers (`bonded-layers`): largest relative difference between the response of the layers with their
        mean thickness and the responses of the most and the least worn column.
    update : {"cycle", "increment"}
        Time at which the surfaces move within a cycle.
    """

    kind: ClassVar[str] = "wear-law"

    body: Literal[1, 2] | None = None
    shares: Shares | None = None
    jump_error: Annotated[float, AfterValidator(in_range(1e-6, 1.0, "[-]"))] | None = None
    cycles_per_update: Annotated[int, AfterValidator(at_least(1))] | None = None
    layer_error: Annotated[float, AfterValidator(in_range(1e-6, 1.0, "[-]"))] = 0.05
    update: Literal["cycle", "increment"] = "cycle"

    @model_validator(mode="after")
    def _single(self) -> Wear:
        for field, alternative in (("body", "shares"), ("jump_error", "cycles_per_update")):
            if getattr(self, field) is not None and getattr(self, alternative) is not None:
                raise ValueError(f"given {field} or {alternative}, not both".replace("_", "-"))
        return self

    @property
    def parts(self) -> dict[int, float]:
        """Share of the worn depth of each body that wears."""
        if self.shares is None:
            return {self.body or 1: 1.0}
        return {body: share for body, share in ((1, self.shares.body1), (2, self.shares.body2)) if share > 0.0}

    @property
    def error(self) -> float | None:
        """Allowed error of the jumps; None if the scene sets their size."""
        return None if self.cycles_per_update is not None else self.jump_error or 1e-2

    def check_in(self, scene: Any) -> None:
        """Require a contact that slides; see `ComponentTable.check_in`."""
        if not scene.geometry:
            raise ValueError("!wear must not be given without a geometry (got no contact that wears); add [geometry]")
        if scene.friction is None and not any(ramp.slides for ramp in scene.ramps):
            raise ValueError(
                "!wear must be of surfaces that slide (got a contact without friction, and no step that slides); give "
                "a step sliding-distance or travel-x, or add [friction] and move the bodies by shift-x"
            )
        if self.update == "cycle" and any(ramp.travels for step in scene.steps for ramp in step.cycle or ()):
            raise ValueError(
                "!wear.update must be 'increment' where a cycle moves the geometry, by travel-x, travel-y or impacts "
                "(got 'cycle'); set update = \"increment\""
            )

    def solved_cycles(self, repeat: int) -> int:
        """Repeats of a cycle that will be solved; where their number follows from errors, a guess.

        Of 100, 5000 and 10⁶ repeats of a partial slip that wears from nothing to all that can wear, 8 to 24, 15 to 45
        and 43 to 50 were solved at an error of 0.01, and about half as many at 0.1.
        """
        if self.error is None:
            return min(repeat, 3 + repeat // (self.cycles_per_update or 1))
        more: float = (0.01 / self.error) ** 0.3
        return min(repeat, 3 + round(2 * more * repeat.bit_length()))
