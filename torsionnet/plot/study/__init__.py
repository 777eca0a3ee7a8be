"""Plots of the answers of studies."""
