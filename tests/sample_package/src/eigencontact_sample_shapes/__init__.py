"""A torus, a spheroid, friction with adhesion, measured eigenstrain, laminates and shear at depth, for eigencontact."""
