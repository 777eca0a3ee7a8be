"""Determinants and minors of symbolic networks as straight-line programs, and algebras that evaluate these."""
