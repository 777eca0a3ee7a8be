"""Checks of the sections of a model file that describe running machinery."""
