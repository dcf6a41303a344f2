"""Sweeps: one scene, many variants, each a run; all numbers in one dataset."""
