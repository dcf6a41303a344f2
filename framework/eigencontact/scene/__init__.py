"""Scene files: schema, units, loading."""
