"""Quantities that a study calculates for every variant, one file for each kind, imported when the kind is used."""
