"""Residuals of a fit, differences between measurement and model, weighted by the noise of the measurement."""
