"""The table of a body: rigid, elastic, layered, with a law, or with the state of an earlier run."""

from __future__ import annotations

from typing import Annotated, Any

from pydantic import AfterValidator, BeforeValidator, model_validator

from eigencontact.core.quantities import FileMark, Stress
from eigencontact.scene.as_tables import table_of
from eigencontact.scene.checks import at_least, finite, in_range, positive
from eigencontact.scene.table import OfKind, Table

__all__ = ["Body", "BulkStress", "FiniteStress", "InitialTable"]

FiniteStress = Annotated[Stress, AfterValidator(finite("Pa"))]


class InitialTable(Table):
    """Initial state of a body: the internal variables of its cells after a step of an earlier run.

    The run uses nothing else of the earlier run. In equal cells the state is equal; in other cells it is the mean of
    the stored state over the cell.

    Parameters
    ----------
    results : str
        Folder of the earlier run, or its ``results.nc``.
    step : int, optional
        Load step of the earlier run, from 1; the last by default.
    """

    results: Annotated[str, FileMark()]
    step: Annotated[int, AfterValidator(at_least(1))] | None = None


class BulkStress(Table):
    """Uniform stress in a body by a distant load, from the start of the history; steps ramp it.

    The surface is free: zz, xz and yz are zero.

    Parameters
    ----------
    xx, yy, xy : float
        Components in the plane of the surface [Pa], tension positive, in the axes of the window for both bodies.
    """

    xx: FiniteStress = 0.0
    yy: FiniteStress = 0.0
    xy: FiniteStress = 0.0


class Body(Table):
    """One half-space: rigid, elastic with two constants, or a medium whose constants change with depth.

    Parameters
    ----------
    rigid : bool
        True for a rigid body, which has no constants.
    young_modulus : float, optional
        Young's modulus [Pa].
    poisson_ratio : float, optional
        Poisson's ratio; 0.5 is incompressible.
    medium : table or component, optional
        Layered medium in place of the two constants; ``type`` names the plugin.
    law : table or component, optional
        Constitutive law of an elastic body below the contact; its elastic constants are those of the body.
    initial : InitialTable, optional
        Initial state of the laws in the body, from an earlier run.
    bulk_stress : BulkStress, optional
        Stress by a distant load. In a layered medium it is the stress of the substrate; the layers have the same
        strain.
    """

    rigid: bool = False
    young_modulus: Annotated[Stress, AfterValidator(positive("Pa"))] | None = None
    poisson_ratio: Annotated[float, AfterValidator(in_range(-1.0, 0.5, "[-]", open_low=True))] | None = None
    medium: Annotated[dict[str, Any] | None, BeforeValidator(table_of), OfKind("layered-medium")] = None
    law: Annotated[dict[str, Any] | None, BeforeValidator(table_of), OfKind("constitutive-law")] = None
    initial: InitialTable | None = None
    bulk_stress: BulkStress | None = None

    @model_validator(mode="after")
    def _complete(self) -> Body:
        if self.rigid and self.law is not None:
            raise ValueError("rigid without a law, or elastic: leave out rigid or law")
        if self.rigid and self.bulk_stress is not None:
            raise ValueError("rigid without bulk stress, or elastic: leave out rigid or bulk-stress")
        if self.medium is not None:
            alternatives = ("rigid", "young_modulus", "poisson_ratio", "law")
            conflicting = [name for name in alternatives if getattr(self, name) not in (None, False)]
            if conflicting:
                rule = f"a medium alone: leave out medium or {', '.join(conflicting)}".replace("_", "-")
                if self.law is not None:
                    rule += (
                        '; layers of one material that yield are law = { type = "by-depth", ... }, others inclusions'
                    )
                raise ValueError(rule)
            return self
        missing = [name for name in ("young-modulus", "poisson-ratio") if getattr(self, name.replace("-", "_")) is None]
        if self.rigid and len(missing) < 2:
            raise ValueError("rigid without elastic constants, or elastic: leave out rigid or young-modulus")
        if not self.rigid and missing:
            raise ValueError(
                f"rigid = true, or elastic with {' and '.join(missing)} given, or layered with medium given"
            )
        return self
