"""Base classes and entries of element types: nodes, laws, curves, damping, stiffness over frequency."""
