"""What a scene stands for: bodies, window, tractions, regions with eigenstrain or a law, points of results."""
