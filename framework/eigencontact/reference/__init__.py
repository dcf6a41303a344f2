"""What a scene may hold, as data: every table, every key, its meaning, unit, choices and default."""
