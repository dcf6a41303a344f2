"""Bundled plugins, registered through the same entry points as an external package."""
