"""Campaigns of rotating tests: records, orders beside the calculation, repeatability and fits from one file."""
