"""Holzer tables, the lines of a mass-elastic system, and vibrations counted by their nodes."""
