"""Interiors of the bodies: prescribed and stress-dependent eigenstrain, which displaces the surface."""
