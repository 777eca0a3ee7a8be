"""Plots of the answers of parameter studies, as contour maps, tornado plots, percentile bands and scatter plots."""
