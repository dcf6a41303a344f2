"""Engines for independent tasks: this process, several processes, or the workers of a cluster."""
