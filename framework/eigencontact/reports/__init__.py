"""Reports of stored runs as one HTML page without other files."""
