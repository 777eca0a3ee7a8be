"""Averaging data of an estimated frequency response, from which its uncertainty follows."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass, field, fields
from typing import Any

from torsionnet.base.packages import UNSAVED


@dataclass(frozen=True, eq=False)
class Estimation:
    """Averaging data of a response estimated by Welch's method, such as window, overlap and number of averages.

    Attributes
    ----------
    estimator, window : str
    seconds : float
        Length of a segment.
    overlap : float
        Overlap of neighbouring segments as a share of a segment.
    detrend : str
    averages : int
        Number of segments.
    effective_averages : float
        Number of independent segments with the same uncertainty.
    swept : bool
        Whether the input was a swept sine.
    settled_from : float
        Lowest frequency in Hz that the sweep passed after the end of the first segment.
    record : torsionnet.signals.Recording, optional
        Signals that were averaged, after decimation; in memory only, not in files.
    steps : mapping of str to float
        Step (resolution) of the sensor of each signal in the record, SI.
    decimation : int
        Samples taken by the sensors for each sample of the record.
    references : tuple of str
        Reference signals of the estimator ``Hr``.
    aligned : float
        Seconds by which the output was moved to earlier times before windows cut the record.
    """

    estimator: str
    window: str
    seconds: float
    overlap: float
    detrend: str
    averages: int
    effective_averages: float
    swept: bool = False
    settled_from: float = 0.0
    record: object = field(default=None, repr=False, metadata=UNSAVED)
    steps: Mapping[str, float] = field(default_factory=dict, repr=False)
    decimation: int = 1
    references: tuple[str, ...] = ()
    aligned: float = 0.0

    def to_data(self) -> dict[str, Any]:
        """Averaging data of an estimated response as plain values for files, by name of the field."""
        return {
            each.name: getattr(self, each.name)
            for each in fields(self)
            if each.name not in ("record", "steps", "decimation")
        }


def estimation_text(estimation: Estimation | None) -> str:
    """Key and averaging data of a response, as its tables say them; empty without any.

    >>> estimation_text(Estimation("H1", "hann", 8.0, 0.75, "mean", 21, 11.8))[:42]
    'estimation: {"estimator": "H1", "window": '
    """
    return "" if estimation is None else f"estimation: {json.dumps(estimation.to_data())}"


def read_estimation(data: Mapping[str, Any]) -> Estimation:
    """Averaging data of an estimated response, read from a mapping that :meth:`Estimation.to_data` has made.

    KeyError, TypeError or ValueError if damaged.
    """
    return Estimation(
        estimator=str(data["estimator"]),
        window=str(data["window"]),
        seconds=float(data["seconds"]),
        overlap=float(data["overlap"]),
        detrend=str(data["detrend"]),
        averages=int(data["averages"]),
        effective_averages=float(data["effective_averages"]),
        swept=bool(data.get("swept", False)),
        settled_from=float(data.get("settled_from", 0.0)),
        references=tuple(map(str, data.get("references", ()))),
        aligned=float(data.get("aligned", 0.0)),
    )
