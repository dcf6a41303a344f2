"""What this package could model and a scene does not ask for, with the reason."""

from __future__ import annotations

from collections.abc import Sequence

from eigencontact.core.grid import Grid
from eigencontact.planning.bodies import layered_bodies
from eigencontact.planning.coupling import Coupling
from eigencontact.planning.kernels import Bodies
from eigencontact.planning.lower_fidelities import PRICE
from eigencontact.planning.plan import LeftOut
from eigencontact.planning.sources import Source
from eigencontact.scene.schema import Scene

__all__ = ["left_out"]


def left_out(
    scene: Scene,
    bodies: Bodies,
    sources: Sequence[Source],
    coupling: Coupling | None = None,
    grid: Grid | None = None,
) -> list[LeftOut]:
    """Return what is not modelled, each with the reason; `coupling` is that of a contact with friction."""
    out = _of_the_contact(bodies, coupling) if scene.geometry else [LeftOut("contact", "the scene has no [geometry]")]
    if not scene.stress:
        asked = "no [[stress]] region asks for it"
        out.append(LeftOut("sub-surface stress" if scene.geometry else "fields below the surface", asked))
    if scene.geometry and coupling is None and not scene.output.tangential_displacement:
        out.append(LeftOut("displacement along x and y", "output.tangential-displacement is false"))
    if scene.geometry and scene.numerics.boundary == "non-periodic":
        out.append(LeftOut("periodic images", 'numerics.boundary = "non-periodic": the half-space is exact'))
    if sources:
        prescribed = [source for source in sources if source.material is None]
        out += _of_the_eigenstrain(scene, sources, prescribed)
    if grid is not None and any(source.material is not None for source in sources):
        from eigencontact.planning.inhomogeneities import layer_that_fills

        layer = layer_that_fills(sources, grid)
        if layer is not None:
            out.append(
                LeftOut(
                    "the exact response of a layered body",
                    f"{layer.name!r}, a flat layer of one material over the whole window, is cut into cells and ends "
                    f'with it; body{layer.body}.medium = {{ type = "bonded-layers", ... }} is exact, and faster',
                )
            )
    return out


def _of_the_contact(bodies: Bodies, coupling: Coupling | None) -> list[LeftOut]:
    if coupling is None:
        why = "the scene prescribes no tangential load and has no friction"
        out = [LeftOut("shear tractions q_x, q_y and their kernels", why)]
    else:
        out = coupling.left_out()
    elastic = [body for body in bodies if body is not None]
    if len(elastic) == 2 and elastic[0] == elastic[1]:
        out.append(
            LeftOut("a second kernel for body 2", "both bodies have the same constants: one kernel, counted twice")
        )
    if layered_bodies(bodies):
        out.append(LeftOut("closed form of the pressure", "a body is layered: none beside that of the bare substrate"))
    if None in bodies:
        number = bodies.index(None) + 1
        out.append(LeftOut(f"deflection and stress of body {number}", "it is rigid"))
    return out


def _of_the_eigenstrain(scene: Scene, sources: Sequence[Source], prescribed: Sequence[Source]) -> list[LeftOut]:
    out = []
    if scene.geometry and prescribed:
        out.append(
            LeftOut(
                "eigenstrain that follows from the contact",
                "it is prescribed: its field adds to that of the pressure, and nothing couples back",
            )
        )
    if all(source.lattice is None for source in sources):
        out.append(LeftOut("cells inside the bodies", "every inclusion has a closed form"))
    if scene.numerics.half_space == "full-space":
        out.append(
            LeftOut("the free surface in the fields of eigenstrain", 'numerics.half-space = "full-space": no images')
        )
    if scene.numerics.half_space in PRICE:
        price = PRICE[scene.numerics.half_space]
        out.append(LeftOut("the exact half-space", f'numerics.half-space = "{scene.numerics.half_space}": {price}'))
    return out
