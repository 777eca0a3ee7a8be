"""Formats of files with recordings and frequency responses, which ``registry`` lists."""
