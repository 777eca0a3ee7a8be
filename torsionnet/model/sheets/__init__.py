"""Makers' mass-elastic sheets: inertias and the shafts between them in a table of text."""
