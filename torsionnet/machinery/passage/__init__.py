"""Passage through critical speeds at a finite rate."""
