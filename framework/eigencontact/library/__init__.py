"""Contact of bodies, and fields of inclusions and tractions at points, from Python objects without a scene file.

Everything here is made of a scene in memory, so that what a scene refuses is refused here, and what a scene can hold
can be put into one later. The names that are exported from the top of the package are stable
(``docs/api/stability.md``); modules in here may change.
"""
