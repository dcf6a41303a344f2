"""Bundled plugins: each is registered through the same entry points as a stranger's package."""
