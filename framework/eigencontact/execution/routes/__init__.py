"""Routes: ways from an eigenstrain to its field at the points of a region, each with its price, words and code."""
