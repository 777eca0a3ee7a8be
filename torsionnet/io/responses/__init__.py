"""Frequency responses in files: what all formats have in common."""
