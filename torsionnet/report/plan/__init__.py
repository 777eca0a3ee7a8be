"""Entries of the ``report:`` section of a model file, which plan the report."""
