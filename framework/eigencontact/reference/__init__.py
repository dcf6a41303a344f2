"""Reference of the scene as data: every table and key with its meaning, unit, choices and default."""
