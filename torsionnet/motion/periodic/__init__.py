"""Periodic motion of drivetrains whose laws are not linear: its branches, its stability, and where it jumps."""
