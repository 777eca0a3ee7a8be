"""Calculation of a study in chunks of fixed size, by one process, several or a cluster, each chunk kept when done."""
