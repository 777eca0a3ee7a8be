"""Library models as cases of a test that solves each: those with many coordinates or configurations where slow tests run."""

import pytest

import torsionnet as tn

LARGE = {"front_wheel_drive_car", "marine_medium_speed", "wind_turbine_3mw"}


def library_cases(names=None):
    """Names of all library models, or of those given, in order, the large ones marked slow."""
    chosen = sorted(tn.library_models()) if names is None else names
    return [pytest.param(name, marks=[pytest.mark.slow] * (name in LARGE)) for name in chosen]
