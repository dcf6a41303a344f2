"""Layered media: one file each."""
