"""A torus and a spheroid for eigencontact."""
