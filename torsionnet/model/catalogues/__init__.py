"""Catalogue tables, from which elements and the limits on them take their entries by size."""
