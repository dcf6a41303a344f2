"""Templates of a plugin package that can be installed and passes its tests without changes."""

from eigencontact.skeleton.package import TEMPLATES, NewPackage, write_file, write_package

__all__ = ["TEMPLATES", "NewPackage", "write_file", "write_package"]
