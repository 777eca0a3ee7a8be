"""Base of the package without any knowledge of drivetrains: errors, units, expressions, warnings, atomic writing."""
