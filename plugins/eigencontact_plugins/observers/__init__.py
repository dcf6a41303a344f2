"""Observers of contact with friction: one file each."""
