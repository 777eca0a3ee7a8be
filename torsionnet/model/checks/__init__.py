"""Checks of names, values, structure and operation of a model."""
