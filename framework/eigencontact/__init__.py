"""Semi-analytical contact mechanics: exact half-space kernels, FFT convolution, constrained solvers, plugins.

The names in ``eigencontact.__all__`` and in ``eigencontact.plugin.__all__``, and what they return, are stable: they
keep their meaning, and warn for a minor version before they go. Everything else may change from one version to the
next (``docs/api/stability.md``).

Examples
--------
>>> import eigencontact as ec
>>> found = ec.solve_contact(ec.make("sphere", radius="105 um"), ec.HalfSpace("210 GPa", 0.3), load="0.65 N")
>>> f"{found.max_pressure / 1e9:.2f} GPa"
'8.47 GPa'
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from eigencontact.afterwards import open_results, region
    from eigencontact.app import explain, load_scene, make, plan, rectangle_field, run
    from eigencontact.errors import EigencontactError, NotConverged
    from eigencontact.facade.bodies import HalfSpace, Layered
    from eigencontact.facade.contact import solve_contact
    from eigencontact.facade.result import ContactResult
    from eigencontact.facade.voxels import Voxels
    from eigencontact.inclusions import inclusion_field
    from eigencontact.pictures.plot import plot
    from eigencontact.reports.report import report
    from eigencontact.scene.schema import Scene
    from eigencontact.sweeps.sweep import sweep

__all__ = [
    "ContactResult",
    "EigencontactError",
    "HalfSpace",
    "Layered",
    "NotConverged",
    "Scene",
    "Voxels",
    "explain",
    "inclusion_field",
    "load_scene",
    "make",
    "open_results",
    "plan",
    "plot",
    "rectangle_field",
    "region",
    "report",
    "run",
    "solve_contact",
    "sweep",
]
__version__ = "0.1.0"

# Public names and the module that defines each: resolved on first use, so that importing the package stays light.
_HOMES = dict.fromkeys(("explain", "load_scene", "make", "plan", "rectangle_field", "run"), "app")
_HOMES |= {"open_results": "afterwards", "region": "afterwards"}
_HOMES |= {"Scene": "scene.schema", "EigencontactError": "errors", "NotConverged": "errors"}
_HOMES |= {"inclusion_field": "inclusions", "sweep": "sweeps.sweep", "report": "reports.report"}
_HOMES |= {"HalfSpace": "facade.bodies", "Layered": "facade.bodies", "Voxels": "facade.voxels"}
_HOMES |= {"solve_contact": "facade.contact", "ContactResult": "facade.result"}
_HOMES |= {"plot": "pictures.plot"}


def __getattr__(name: str) -> Any:
    if name in _HOMES:
        return getattr(import_module(f"eigencontact.{_HOMES[name]}"), name)
    raise AttributeError(f"module 'eigencontact' has no attribute {name!r}; public names: {', '.join(__all__)}")


def __dir__() -> list[str]:
    return sorted(__all__)
