"""Bodies that many tests press together."""

#: As arguments in Python.
STEEL = {"young_modulus": 210e9, "poisson_ratio": 0.3}
#: As keys of a scene file.
STEEL_TABLE = {"young-modulus": 210e9, "poisson-ratio": 0.3}
