"""Reference of the scene as data: all tables and keys with meaning, unit, choices and default."""
