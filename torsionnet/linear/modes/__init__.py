"""Natural frequencies, damping ratios and mode shapes, with descriptions, pairs of modes and Holzer tables."""
