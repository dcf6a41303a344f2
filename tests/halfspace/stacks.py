"""Layered media of tests, by shear modulus and Poisson's ratio."""

from eigencontact_plugins.layered.stack import BondedLayers, Layer, Substrate


def solid(G, nu):
    return {"young_modulus": 2 * G * (1 + nu), "poisson_ratio": nu}


def medium(layers, substrate):
    """Layers of (thickness, G, nu) on a substrate of (G, nu)."""
    return BondedLayers(
        layers=tuple(Layer(thickness=h, **solid(G, nu)) for h, G, nu in layers),
        substrate=Substrate(**solid(*substrate)),
    )
