"""Symbolic transfer functions of drivetrains: one straight-line program per function, evaluated in many algebras."""
