"""Draw `contact-and-elements.png`: a contact over a stiff ball, and the finite elements that check it.

Usage, in a folder for scratch files::

    eigencontact run inclusion-under-contact -o run
    eigencontact verify --quick run -o audit
    python docs/pictures/contact_and_elements.py run audit
"""

from __future__ import annotations

import json
import sys
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import eigencontact as ec

#: Radius and depth of the ball in the scene, and the size of a cell in it [um].
RADIUS, DEPTH, CELL = 1.0291, 3.0267, 0.17
COMPONENTS = {"s_zz": ("σ_zz", "tab:blue", "o"), "s_xx": ("σ_xx", "tab:orange", "s")}


def draw(run: Path, audit: Path, file: Path) -> None:
    """Section of the run above, stress down the axis by both methods below."""
    checked = json.loads(next((audit / "figures").glob("*step-1.json")).read_text("utf-8"))["axis, line"]
    with ec.open_results(run) as results:
        last = results.isel(step=-1)
        figure, (above, below) = plt.subplots(2, 1, figsize=(6.4, 7.2), height_ratios=(1.15, 1), layout="constrained")
        stress = last["section_von_mises"].squeeze()
        mesh = above.pcolormesh(
            1e6 * stress["section_x"], 1e6 * stress["section_z"], 1e-9 * stress.values, shading="gouraud"
        )
        figure.colorbar(mesh, ax=above, label="von Mises stress [GPa]", shrink=0.66)
        above.add_patch(plt.Circle((0, DEPTH), RADIUS, fill=False, color="white", lw=1.5))
        radius = 1e6 * float(last["contact_radius"])
        above.plot([-radius, radius], [0, 0], color="black", lw=5, solid_capstyle="butt", clip_on=False)
        above.set(xlabel="x [µm]", ylabel="depth z [µm]", aspect="equal", ylim=(9, 0))
        axis = last["axis_stress"]
        depth = 1e6 * np.asarray(axis["axis_z"])
        outside = np.abs(np.abs(depth - DEPTH) - RADIUS) > CELL  # cells across the border mix both materials
        for name, (label, colour, symbol) in COMPONENTS.items():
            at = checked["components"].index(name)
            values = 1e-9 * axis.sel(component=name.removeprefix("s_")).values.squeeze()
            below.plot(depth, np.where(outside, values, np.nan), color=colour, label=f"{label}, eigencontact")
            below.errorbar(
                1e6 * np.asarray(checked["points"])[:, 2],
                1e-9 * np.asarray(checked["finite_elements"])[:, at],
                1e-9 * np.asarray(checked["uncertainty"])[:, at],
                fmt=symbol, mfc="none", color=colour, label=f"{label}, finite elements",
            )  # fmt: skip
        below.axvspan(DEPTH - RADIUS, DEPTH + RADIUS, color="0.9", zorder=0, label="ball")
        below.set(xlabel="depth z on the axis [µm]", ylabel="stress [GPa]", xlim=(0, 9))
        below.legend(fontsize=9)
        figure.savefig(file, dpi=150)


if __name__ == "__main__":
    draw(Path(sys.argv[1]), Path(sys.argv[2]), Path(__file__).with_name("contact-and-elements.png"))
