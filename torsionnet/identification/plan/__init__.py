"""Entries of a fit file, which say what is fitted to which tests."""
