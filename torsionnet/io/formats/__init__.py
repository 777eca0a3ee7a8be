"""Formats of files with records and frequency responses; ``registry`` lists them."""
