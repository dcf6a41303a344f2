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
    from eigencontact.app import explain, load_scene, plan, run
    from eigencontact.errors import EigencontactError, NotConverged
    from eigencontact.library.bodies import HalfSpace, Layered
    from eigencontact.library.components import make, rectangle_field
    from eigencontact.library.contact import solve_contact
    from eigencontact.library.inclusions import inclusion_field
    from eigencontact.library.result import ContactResult
    from eigencontact.library.voxels import Voxels
    from eigencontact.postprocess.crack import crack
    from eigencontact.postprocess.fatigue import fatigue
    from eigencontact.postprocess.plot import plot
    from eigencontact.postprocess.shakedown import shakedown
    from eigencontact.postprocess.stored_run import open_results, region
    from eigencontact.reports.report import report
    from eigencontact.scene.schema import Scene
    from eigencontact.sweeps.fretting_map import fretting_map
    from eigencontact.sweeps.sweep import sweep

__all__ = [
    "ContactResult",
    "EigencontactError",
    "HalfSpace",
    "Layered",
    "NotConverged",
    "Scene",
    "Voxels",
    "crack",
    "explain",
    "fatigue",
    "fretting_map",
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
    "shakedown",
    "solve_contact",
    "sweep",
]
__version__ = "0.1.0"

# Public names and the module that defines each: resolved on first use, so that importing the package stays light.
_HOMES = dict.fromkeys(("explain", "load_scene", "plan", "run"), "app")
_HOMES |= {"open_results": "postprocess.stored_run", "region": "postprocess.stored_run", "plot": "postprocess.plot"}
_HOMES |= {name: f"postprocess.{name}" for name in ("fatigue", "crack", "shakedown")}
_HOMES |= {"fretting_map": "sweeps.fretting_map"}
_HOMES |= {"Scene": "scene.schema", "EigencontactError": "errors", "NotConverged": "errors"}
_HOMES |= {"inclusion_field": "library.inclusions", "sweep": "sweeps.sweep", "report": "reports.report"}
_HOMES |= {"HalfSpace": "library.bodies", "Layered": "library.bodies", "Voxels": "library.voxels"}
_HOMES |= {"solve_contact": "library.contact", "ContactResult": "library.result"}
_HOMES |= {"make": "library.components", "rectangle_field": "library.components"}


def __getattr__(name: str) -> Any:
    if name in _HOMES:
        return getattr(import_module(f"eigencontact.{_HOMES[name]}"), name)
    raise AttributeError(f"module 'eigencontact' has no attribute {name!r}; public names: {', '.join(__all__)}")


def __dir__() -> list[str]:
    return sorted(__all__)
