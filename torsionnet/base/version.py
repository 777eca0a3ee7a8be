"""Version number of the package ``torsionnet``."""

__version__ = "1.0.0"
