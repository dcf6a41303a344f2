"""Laws of materials for tests: of implicit return, of hardening elasticity, of a neighbourhood; linear ones."""

# ruff: noqa: ARG002 - the interface of a law

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from eigencontact.plugin import (
    ConstitutiveLaw,
    Direction,
    Length,
    LinearLaw,
    Response,
    Stress,
    Variable,
    hookimpl,
    isotropic_stiffness,
    require,
    unit_vector,
)

#: Deviator of a Mandel vector.
DEVIATOR = np.eye(6) - np.pad(np.full((3, 3), 1.0 / 3.0), (0, 3))


@dataclass(frozen=True, kw_only=True)
class Yielding(ConstitutiveLaw):
    """Isotropic elasticity up to a yield stress that grows with the plastic strain (von Mises, radial return)."""

    key: ClassVar[str] = "yielding"
    references: ClassVar[tuple[str, ...]] = ("J. C. Simo, T. J. R. Hughes 1998, Computational Inelasticity, box 3.2",)
    isotropic: ClassVar[bool] = True
    variables: ClassVar = {
        "plastic_strain": Variable(unit="1", meaning="plastic strain, Mandel components", components=6),
        "hardening": Variable(unit="Pa", meaning="growth of the yield stress"),
    }

    young_modulus: Stress
    poisson_ratio: float
    yield_stress: Stress
    hardening_modulus: Stress

    def __post_init__(self):
        for name in ("young_modulus", "yield_stress"):
            require(0 < getattr(self, name) < np.inf, self.key, name, getattr(self, name), "positive and finite [Pa]")
        for name, high in (("poisson_ratio", 0.5), ("hardening_modulus", np.inf)):
            require(0 <= getattr(self, name) < high, self.key, name, getattr(self, name), f"from 0 to below {high}")

    def update(self, strain, before, step):
        stiffness = isotropic_stiffness(self.young_modulus, self.poisson_ratio)
        shear = self.young_modulus / (1.0 + self.poisson_ratio)  # 2 G
        trial = stiffness @ (strain - before["plastic_strain"])
        size = np.linalg.norm(DEVIATOR @ trial, axis=0)
        beyond = np.maximum(size - np.sqrt(2 / 3) * (self.yield_stress + before["hardening"][0]), 0.0)
        direction = DEVIATOR @ trial / np.where(size > 0.0, size, 1.0)
        soft = shear + 2 / 3 * self.hardening_modulus
        flow = beyond / soft
        back = np.where(beyond > 0.0, shear * flow / np.where(size > 0.0, size, 1.0), 0.0)
        outer = direction[:, None] * direction[None]
        tangent = stiffness[..., None] - shear * (DEVIATOR[..., None] - outer) * back
        tangent -= np.where(beyond > 0.0, shear * shear / soft, 0.0) * outer
        after = {
            "plastic_strain": before["plastic_strain"] + flow * direction,
            "hardening": before["hardening"] + np.sqrt(2 / 3) * self.hardening_modulus * flow,
        }
        return Response(stress=trial - shear * flow * direction, tangent=tangent, variables=after)


@dataclass(frozen=True, kw_only=True)
class Stiffening(ConstitutiveLaw):
    """Elastic without memory: the energy is that of a shear modulus G with a term of fourth order, nowhere linear."""

    key: ClassVar[str] = "stiffening"
    references: ClassVar[tuple[str, ...]] = ("elementary: stress is the derivative of an energy",)
    isotropic: ClassVar[bool] = True

    shear_modulus: Stress
    growth: float

    def __post_init__(self):
        require(0 < self.shear_modulus < np.inf, self.key, "shear_modulus", self.shear_modulus, "positive, finite [Pa]")
        require(0 <= self.growth < np.inf, self.key, "growth", self.growth, "zero or positive, and finite [-]")

    def update(self, strain, before, step):
        G, squared = self.shear_modulus, np.sum(strain * strain, axis=0)
        outer = strain[:, None] * strain[None]
        tangent = 2 * G * ((1 + self.growth * squared) * np.eye(6)[..., None] + 2 * self.growth * outer)
        return Response(stress=2 * G * (1 + self.growth * squared) * strain, tangent=tangent)


@dataclass(frozen=True, kw_only=True)
class Waning(ConstitutiveLaw):
    """Loses stiffness down to half by the largest strain so far, or by its mean about the point."""

    key: ClassVar[str] = "waning"
    references: ClassVar[tuple[str, ...]] = ("J. Lemaitre, J.-L. Chaboche 1990, Mechanics of Solid Materials, 7",)
    isotropic: ClassVar[bool] = True
    symmetric: ClassVar[bool] = False
    variables: ClassVar = {
        "strained": Variable(unit="1", meaning="largest strain so far"),
        "lost": Variable(unit="1", meaning="part of the stiffness that is lost"),
    }

    young_modulus: Stress
    poisson_ratio: float
    strain: float
    radius: Length

    def __post_init__(self):
        for name in ("young_modulus", "strain", "radius"):
            require(0 < getattr(self, name) < np.inf, self.key, name, getattr(self, name), "positive and finite")
        require(0 <= self.poisson_ratio < 0.5, self.key, "poisson_ratio", self.poisson_ratio, "from 0 to below 0.5")

    @property
    def averaged(self):
        return {"strained": self.radius}

    def loss(self, most):
        """Part of the stiffness that is lost, and its derivative."""
        fading = np.exp(-most / self.strain)
        return 0.5 * (1.0 - fading), 0.5 * fading / self.strain

    def update(self, strain, before, step):
        size = np.linalg.norm(strain, axis=0)
        most = np.maximum(size, before["strained"][0])
        mean = step.means.get("strained")
        lost, slope = self.loss(most if mean is None else np.maximum(mean[0], 0.0))
        stiffness = isotropic_stiffness(self.young_modulus, self.poisson_ratio)
        sound, grows = stiffness @ strain, (size > before["strained"][0]) & (mean is None)
        direction = strain / np.where(size > 0.0, size, 1.0)
        tangent = (1.0 - lost) * stiffness[..., None] - np.where(grows, slope, 0.0) * sound[:, None] * direction[None]
        after = {"strained": most[None], "lost": lost[None]}
        return Response(stress=(1.0 - lost) * sound, tangent=tangent, variables=after)


@dataclass(frozen=True, kw_only=True)
class Fibred(LinearLaw):
    """Isotropic of ν = 0, with fibres along one direction."""

    key: ClassVar[str] = "fibred"
    references: ClassVar[tuple[str, ...]] = ("elementary: sum of two energies",)

    young_modulus: Stress
    fibre_modulus: Stress
    direction: Direction = (1.0, 0.0, 0.0)

    def __post_init__(self):
        for name in ("young_modulus", "fibre_modulus"):
            require(0 <= getattr(self, name) < np.inf, self.key, name, getattr(self, name), "zero or positive [Pa]")
        unit_vector(self.key, "direction", self.direction)

    def stiffness_matrix(self):
        x, y, z = unit_vector(self.key, "direction", self.direction)
        root = np.sqrt(2.0)
        along = np.array([x * x, y * y, z * z, root * y * z, root * x * z, root * x * y])
        return self.young_modulus * np.eye(6) + self.fibre_modulus * np.outer(along, along)


@hookimpl
def eigencontact_register():
    """Register the laws, where this module is the plugin of a package."""
    return [Yielding, Stiffening, Fibred]
