"""Errors, units, expressions, warnings and atomic writing, the base of the package that knows no drivetrains."""
