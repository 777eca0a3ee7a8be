"""Entries of fit files."""

from torsionnet.model.fit.fit_entries import (
    QUANTITIES,
    READING,
    FileReading,
    FitFile,
    FitMeasurement,
    FitParameter,
    FitSettings,
)

__all__ = ["QUANTITIES", "READING", "FileReading", "FitFile", "FitMeasurement", "FitParameter", "FitSettings"]
