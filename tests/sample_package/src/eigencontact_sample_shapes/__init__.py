"""A torus, a spheroid, and friction with adhesion for eigencontact."""
