"""Cases whose finite-element values are exact + C h^p, for tests of the campaign; importable in other processes."""

import os
import time
from dataclasses import dataclass

import numpy as np

from eigencontact_verification.crosscheck.case import Case, Gap, Profile

LINE = np.linspace(0.0, 2.0, 15)
POINTS = np.stack([LINE, 0.0 * LINE, 0.0 * LINE], axis=-1)
DISPLACEMENT = Profile(
    name="x axis", quantity="displacement", points=POINTS, along=LINE, label="x / edge",
    components=("u_x", "u_y", "u_z"), unit="edge",
)  # fmt: skip
STRESS = Profile(
    name="below", quantity="stress", points=POINTS[:, ::-1], along=LINE, label="z / edge",
    components=("s_xx", "s_xz"), unit="E",
)  # fmt: skip


@dataclass(frozen=True, kw_only=True, eq=False)
class Analytic(Case):
    """`fault` is what is wrong: judged values ("sign", "factor"), or how the reference misbehaves."""

    fault: str = ""

    def exact(self):
        u = np.stack([np.exp(-LINE), 0.0 * LINE, np.cos(LINE)], axis=-1)
        s = np.stack([np.cos(LINE), 0.5 * np.exp(-LINE)], axis=-1)
        return {"x axis": u, "below": s}

    def reference(self, level, outer):
        if self.fault == "raises" and level == 2:
            raise RuntimeError("mesh is tangled")
        if self.fault == "dies" and level == 1:
            os._exit(3)
        if self.fault == "sleeps" and level == 1 and outer == "fixed":
            time.sleep(60.0)
        if self.fault == "eats" and level == 1 and outer == "fixed":
            held = np.ones((60_000_000,))  # 480 MB
            time.sleep(0.3 + 0.0 * held[0])
        if self.fault == "shape":
            return {name: values[1:] for name, values in self.exact().items()}
        size = self.parameters.get("error", 0.002) * 4.0 ** (2 - level)
        shift = -0.0005 if outer == "fixed" else 0.0005
        mask = {"x axis": np.array([1.0, 0.0, 1.0]), "below": np.array([1.0, 0.2])}
        return {
            name: values + mask[name] * (size * np.exp(-LINE)[:, None] + shift) for name, values in self.exact().items()
        }

    def judged(self):
        found = self.exact()
        if self.fault == "sign":
            found["below"] = found["below"] * np.array([1.0, -1.0])
        if self.fault == "factor":
            found["x axis"] = 2.0 * found["x axis"]
        return found


def analytic(name, fault="", *, subject="analytic", error=0.002, quick=True):
    return Analytic(
        subject=subject, name=name, parameters={"error": error, "fault": fault}, quick=quick,
        profiles=(DISPLACEMENT, STRESS), fault=fault,
    )  # fmt: skip


def kernels():
    return ("analytic", "other")


def cases_of(kernel):
    if kernel == "other":
        return (analytic("blunt", subject="other", error=0.02),)
    return (analytic("plain"), analytic("full", quick=False, error=0.001))


def gaps():
    return (Gap(subject="other", what="stress inside", reason="the exact field is singular there"),)


def why_not(kernel):
    return "shape 'odd' must be buildable from lengths" if kernel == "odd" else ""
