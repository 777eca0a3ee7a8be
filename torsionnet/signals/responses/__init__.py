"""Frequency responses in files, with what all file formats have in common."""
