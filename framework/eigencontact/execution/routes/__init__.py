"""Methods to compute the field of an eigenstrain at the points of a region, each with cost, description and code."""
