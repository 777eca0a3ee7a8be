"""Entries of fit files."""

from torsionnet.model.fit.fit_entries import FitFile, FitMeasurement, FitParameter, FitSettings

__all__ = ["FitFile", "FitMeasurement", "FitParameter", "FitSettings"]
