"""Warnings and error estimates before and after a run, and the sizes that a plan reads from a scene."""
