"""Conversion of a study's result to labelled arrays of xarray."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from torsionnet.base.errors import MissingExtraError
from torsionnet.linear.assembly.rows import FloatArray
from torsionnet.study.reductions.quantity_summary import Summary

Cases = Mapping[tuple[str, str], FloatArray]


def labelled_variants(
    summaries: Mapping[tuple[str, str], Summary],
    values: Cases,
    bands: Cases,
    percentiles: tuple[float, ...],
    parameters: Mapping[str, Mapping[str, FloatArray]],
    attributes: Mapping[str, Any],
) -> Any:
    """Build an ``xarray.Dataset``, numbers over configuration and variant, curves over configuration and percentile.

    Parameters
    ----------
    summaries, values, bands : mapping
        By configuration and quantity; values (n,) of those numbers that are kept, percentiles (n_shares, n_points) of
        curves.
    percentiles : tuple of float
        Per cent.
    parameters : mapping
        Configuration -> parameter -> (n,) values.
    attributes : mapping
        Attributes of the dataset: title, seed, version, study, model, notes.
    """
    try:
        import xarray as xr
    except ImportError as error:
        raise MissingExtraError('labelled arrays need xarray: pip install "torsionnet[xarray]"') from error
    cases = list(parameters)
    variables: dict[str, Any] = {}
    coordinates: dict[str, Any] = {"configuration": cases, "percentile": list(percentiles)}
    for (case, name), one in summaries.items():
        if case != cases[0]:
            continue
        unit = {"units": one.measure.unit}
        if (case, name) in values:
            variables[name] = ("configuration", "variant"), np.stack([values[each, name] for each in cases]), unit
        elif (case, name) in bands:
            axis = f"{one.measure.over}_of_{name}"
            coordinates[axis] = (
                axis,
                one.measure.points,
                {"units": "Hz" if one.measure.over == "frequency" else "rad/s"},
            )
            stacked = np.stack([bands[each, name] for each in cases])
            variables[name] = ("configuration", "percentile", axis), stacked, unit
    for name in parameters[cases[0]]:
        drawn = np.stack([parameters[case][name] for case in cases])
        variables[name] = ("configuration", "variant"), drawn, {"units": "SI"}
    return xr.Dataset(variables, coordinates, dict(attributes))
