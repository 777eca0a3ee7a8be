"""Variations of a parameter: distributions, lists and ranges, one class for each word in ``type:``."""
