"""Stress, strain and displacement at points below the surface, by tractions and by eigenstrain."""
