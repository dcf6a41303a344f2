"""Trade-off: one scene at several fidelities, their errors, times and memory."""
