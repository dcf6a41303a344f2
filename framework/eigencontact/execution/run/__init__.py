"""Course of a run: load points, the driver, observers."""
