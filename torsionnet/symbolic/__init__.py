"""Symbolic transfer functions of drivetrains, each recorded as a straight-line program that many algebras evaluate."""
