"""Version number of the package ``torsionnet``."""

__version__ = "0.1.0"
