"""The start of a plugin package of one's own: written from templates, installable, and passing its tests as it is."""

from eigencontact.skeleton.package import TEMPLATES, NewPackage, write_file, write_package

__all__ = ["TEMPLATES", "NewPackage", "write_file", "write_package"]
