"""Typed entries of model files and of Python calls, each with its unit, bounds and description in one place.

A class that is declared with :func:`entry` (:class:`Declared`) is read from a file, checked, written back, described by
a JSON Schema and listed in the documentation from the same specifications.
"""
