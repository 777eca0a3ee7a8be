"""View of a model in one condition for its limits, apart from the definition, which itself holds limits."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from torsionnet.model.channels import Sensor
from torsionnet.model.elements import Element


@dataclass(frozen=True, eq=False)
class LimitSubject:
    """Model in one condition, with the elements, nodes, sensors and values that limits need.

    Attributes
    ----------
    elements, active : mapping
        All elements by name, and those that are switched on.
    nodes, active_nodes : tuple of str
        Of these.
    sensors : mapping
        As declared, by name.
    speeds : tuple of float
        At which it is examined, rad/s of the reference shaft; empty where the model does not say.
    rated : float, optional
        Rated speed of that shaft, rad/s.
    misfiring : bool
        Whether a cylinder does not fire.
    values : mapping
        Exact value of every parameter.
    is_generating_set : bool
        Whether a piston engine drives a generator and no propeller.
    """

    elements: Mapping[str, Element]
    active: Mapping[str, Element]
    nodes: tuple[str, ...]
    active_nodes: tuple[str, ...]
    sensors: Mapping[str, Sensor]
    speeds: tuple[float, ...]
    rated: float | None
    misfiring: bool
    values: Mapping[str, Any]
    is_generating_set: bool = False
