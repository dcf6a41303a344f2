"""Verification: oracles that share no code with the kernels, and benchmarks."""
