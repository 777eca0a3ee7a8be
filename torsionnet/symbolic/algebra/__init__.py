"""Determinants and minors of symbolic networks as straight-line programs, and the algebras that evaluate them."""
