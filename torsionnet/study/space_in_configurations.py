"""A space of variants in configurations of its model: what is wrong in some of them only."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from torsionnet.core.errors import Fault
from torsionnet.model.model import Model
from torsionnet.study.space.space import Space


def faults_in(space: Space, models: Mapping[str, Model]) -> list[Fault]:
    """What is found in configurations besides what the space knows, and where these have no effect.

    Parameters
    ----------
    space : Space
    models : mapping
        The model in each configuration, by its name.
    """
    known = {(fault.path, fault.message) for fault in space.remarks}
    faults: list[Fault] = []
    spaces: dict[str, Space] = {}
    for name, model in models.items():
        there, found = Space.of(space.entries, model)
        faults += [replace(one, configuration=name) for one in found if (one.path, one.message) not in known]
        if there is not None:
            spaces[name] = there
    return faults + _overruled(spaces)


def _overruled(spaces: Mapping[str, Space]) -> list[Fault]:
    """Parameters to which configurations give values of their own, all of which a variation replaces by the same."""
    names = next(iter(spaces.values())).names if spaces else ()
    faults = []
    for name in names:
        own = {space.nominal[name] for space in spaces.values()}
        taken = {_typical(space, name) for space in spaces.values()}
        if len(own) > 1 and len(taken) == 1:
            text = f"{name} has values of its own in {', '.join(spaces)}, and this variation gives it the same in all"
            faults.append(
                Fault(f"{text}; in percent, as -10 %, it is relative to each of them", ("vary", name), "warning")
            )
    return faults


def _typical(space: Space, name: str) -> tuple[float, ...]:
    if name in space.grid:
        axis = space.grid[name]
        return axis.low, axis.high
    return tuple(space.marginals[name].ppf(np.array([0.1, 0.9])).tolist())
