"""Discovery of plugins: hook specifications, a guarded loader, and the registry."""
