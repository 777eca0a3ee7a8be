"""Determinants and minors of rows with symbols, as short programs, and the algebras they run in."""
