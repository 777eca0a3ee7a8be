"""Transfer functions in symbols: one recursion on the graph, read in many algebras."""
