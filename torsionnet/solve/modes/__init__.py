"""Natural frequencies, damping ratios and mode shapes: poles of the rows, and their words, pairs and Holzer tables."""
