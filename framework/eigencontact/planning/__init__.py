"""From requested outputs backwards to the blocks and kernels a run needs."""
