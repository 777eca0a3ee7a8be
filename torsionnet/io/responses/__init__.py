"""Frequency responses in files: CSV, NPZ, MAT and, with an extra, UFF58."""
