"""Rows of the dynamic stiffness, their elimination and null spaces, and what is asked of them."""
