"""Calculation of a study in chunks of variants, by one process, several or a cluster, each chunk kept when done."""
