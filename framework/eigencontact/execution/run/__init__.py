"""The course of a run: load points, the driver, observers."""
