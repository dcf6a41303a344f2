"""Who performs tasks that do not know of each other: this process, several processes, or the workers of a cluster."""
