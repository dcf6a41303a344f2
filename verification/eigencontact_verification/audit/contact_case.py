"""A whole contact of revolution, solved by finite elements along the run's loads, beside what the run stores."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar

import numpy as np
from numpy.typing import NDArray

from eigencontact_verification.audit.contact_model import contact_model
from eigencontact_verification.crosscheck.case import Case, Fields, Level, Outer, Profile, own_error
from eigencontact_verification.fem.yielding import solve_indentation

if TYPE_CHECKING:
    from eigencontact_verification.fem.yielding import IndentationSolution

__all__ = ["ContactCase", "ContactLine"]

FloatArray = NDArray[np.float64]


@dataclass(frozen=True, kw_only=True, eq=False)
class ContactLine:
    """What is compared along one line, and what the run stores there.

    Attributes
    ----------
    profile : Profile
        ``along`` of lines over load steps is the number of the step.
    kind : str
        ``"approach"``, ``"radius"``, ``"pressure"``, ``"print"`` or ``"stress"``.
    moments : tuple of int
        Load steps, from 0: of every point, or one for all.
    values, own : (n, components) float64
        Stored values and their numerical error.
    """

    profile: Profile
    kind: str
    moments: tuple[int, ...]
    values: FloatArray
    own: FloatArray


@dataclass(frozen=True, kw_only=True, eq=False)
class ContactCase(Case):
    """What a run of revolution stores against finite elements that find the contact themselves.

    Both take the same load steps, by backward Euler: what they share of its error is not judged. `parameters` are those
    of `contact_scene.ContactScene.numbers`, with ``loads`` [N], ``mesh``, and ``divisions`` of its elements by level.

    Parameters
    ----------
    lines : tuple of ContactLine
        Their profiles are `profiles`.
    """

    lines: tuple[ContactLine, ...]

    code: ClassVar[tuple[str, ...]] = (
        "eigencontact_verification.audit.contact_model",
        "eigencontact_verification.crosscheck.plasticity:point_law",
        "eigencontact_verification.crosscheck.plasticity:_curve",
        f"{__name__}:ContactCase.reference",
        f"{__name__}:_read",
    )
    method: ClassVar[str] = "finite elements with a contact of their own"

    def reference(self, level: Level, outer: Outer) -> Fields:
        """Values of the elements at the points of every line."""
        model = contact_model(self.parameters, self.parameters["divisions"][level], outer)
        found = solve_indentation(model, self.parameters["loads"])
        return {line.profile.name: _read(found, line, self.parameters["mesh"]["radius"]) for line in self.lines}

    def judged(self) -> Fields:
        """Stored values, with their own error."""
        fields: Fields = {}
        for line in self.lines:
            fields[line.profile.name] = line.values
            if np.any(line.own):
                fields[own_error(line.profile.name)] = line.own
        return fields

    def remedy(self, part: str, excess: float) -> str:  # noqa: ARG002
        """The finer meshes of a full audit; see `Case.remedy`."""
        if part == "judged":
            return "run the scene with finer cells"
        return "repeat without --quick, on finer meshes" if self.quick and part == "discretisation" else ""

    @property
    def words(self) -> str:
        """What is compared, for the figures."""
        return f"{self.subject}: stored (semi-analytical) and finite elements of the whole contact"


def _read(found: IndentationSolution, line: ContactLine, widest: float) -> FloatArray:
    """Values (n, components) of a line; radii in the widest of the run."""
    if line.kind == "approach":
        return np.array([[found.moments[k].depth] for k in line.moments])
    if line.kind == "radius":
        return np.array([[found.moments[k].contact_radius / widest] for k in line.moments])
    (moment,) = line.moments
    x, y, z = line.profile.points.T
    r = np.hypot(x, y)
    if line.kind == "print":
        return np.asarray(found.surface_displacement(r, moment)[:, None])
    if line.kind == "pressure":
        s, p = found.surface.r**2, found.moments[moment].pressure ** 2  # p² is smooth in r² to the edge
        middle = p[0] - s[0] * (p[1] - p[0]) / (s[1] - s[0])
        root = np.sqrt(np.interp(r**2, np.insert(s, 0, 0.0), np.insert(p, 0, max(middle, 0.0))))
        return np.asarray(-root[:, None])
    rr, tt, zz, rz = found.stress(np.stack((r, z), axis=1), moment)
    c, s = np.where(r > 0, x / np.where(r > 0, r, 1.0), 1.0), np.where(r > 0, y / np.where(r > 0, r, 1.0), 0.0)
    columns = {"s_xx": c * c * rr + s * s * tt, "s_yy": s * s * rr + c * c * tt, "s_zz": zz, "s_xz": c * rz}
    return np.stack([columns[name] for name in line.profile.components], axis=1)
