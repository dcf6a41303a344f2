"""The library that one can hold: bodies, a contact between them, fields at points.

Everything here is made of a scene in memory, so that what a scene refuses is refused here, and what a scene can hold
can be put into one later. The names that are exported from the top of the package are stable
(``docs/api/stability.md``); modules in here may change.
"""
