"""A torus, a spheroid, friction with adhesion, and measured eigenstrain for eigencontact."""
