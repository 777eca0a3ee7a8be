"""What several quantities of a variant have in common: modes, transfer functions, peaks, orders, histories."""
