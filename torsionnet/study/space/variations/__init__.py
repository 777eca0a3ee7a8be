"""Variations of a parameter, which are distributions, lists and ranges, one class for each type in a study file."""
