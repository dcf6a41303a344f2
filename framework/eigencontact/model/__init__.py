"""Physical model of a scene: bodies, window, tractions, regions with eigenstrain or a law, points of results."""
