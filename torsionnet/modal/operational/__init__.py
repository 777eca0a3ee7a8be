"""Natural frequencies and damping ratios of turning machinery without a measured input: run-up, decay, ambient."""
