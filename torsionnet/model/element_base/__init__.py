"""What element types are made of: nodes, laws, curves, damping, stiffness over frequency."""
