"""Differences of measurement and model, weighted by what the noise of the measurement is."""
