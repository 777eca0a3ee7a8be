"""Symbolic transfer functions of drivetrains, each recorded as one straight-line program for many algebras."""
