"""Solvers for the dynamic stiffness: transfer requests, elimination plans, null spaces and first-order forms."""
