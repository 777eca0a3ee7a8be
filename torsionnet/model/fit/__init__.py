"""What a fit is about, as a file says it."""

from torsionnet.model.fit.fit_entries import FitFile, FitMeasurement, FitParameter, FitSettings

__all__ = ["FitFile", "FitMeasurement", "FitParameter", "FitSettings"]
