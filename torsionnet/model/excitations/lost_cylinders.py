"""Share of its mean torque that each cylinder of a piston machine keeps where some have lost injection or gas."""

from __future__ import annotations

import numpy as np

from torsionnet.core.errors import UsageError
from torsionnet.model.excitations.cylinder_entries import EACH
from torsionnet.model.excitations.engine_entries import EngineEntries
from torsionnet.model.excitations.order_excitation import FloatArray

MEAN = np.zeros(1)
"""Orders of the mean torque alone: a mean value is the harmonic of order 0."""


def mean_torque_shares(engine: EngineEntries, speeds: FloatArray) -> dict[int, FloatArray]:
    """Mean gas torque of each cylinder over that of the same cylinder working, (n_speeds,), by cylinder number.

    Working cylinders keep their pressures (1). Without gas torque a cylinder gives nothing (0); without injection the
    mean of the motored trace over that of the fired one counts, and nothing where tables by order say no mean. Where
    each cylinder misfires in turn, all have the mean over the cases: their sum is that of any one case.

    Parameters
    ----------
    engine : EngineEntries
        With its cylinders that have no injection (``misfire``) or no gas (``gas_off``).
    speeds : (n_speeds,) array
        rad/s, of the crankshaft, above 0.

    Examples
    --------
    >>> engine = EngineEntries(speed_of="c1", cycle=2, cylinders={1: "c1", 2: "c2"}, firing_order=[1, 2],
    ...     bore="100 mm", stroke="120 mm", rod_length="240 mm", gas_off=[2])
    >>> {number: share.tolist() for number, share in mean_torque_shares(engine, np.array([100.0])).items()}
    {1: [1.0], 2: [0.0]}
    """
    whole, out = np.ones(len(speeds)), {*engine.gas_off}
    silent = {*engine.numbers} if engine.misfire == EACH else {*engine.misfire}
    shares = {int(number): share for number, share in (engine.misfire_share or {}).items()}
    without = _without_injection(engine, speeds) if silent or shares else whole
    part = without
    if engine.misfire == EACH:
        without = 1 - (1 - without) / len(engine.numbers)
    found = {number: whole + shares.get(number, 0.0) * (part - whole) for number in engine.numbers}
    return found | dict.fromkeys(silent, without) | dict.fromkeys(out, 0 * whole)


def _without_injection(engine: EngineEntries, speeds: FloatArray) -> FloatArray:
    """Mean gas torque of a cylinder without injection over that with it, (n_speeds,), 0 where neither is known."""
    gas, nothing = engine.gas, np.zeros(len(speeds))
    if gas is None:
        return nothing
    try:
        fired = gas.fired_harmonics(engine.crank, MEAN, engine.indicated_pressures(speeds))[:, 0].real
    except UsageError:  # a load beyond the traces, of which the torques by order say it
        return nothing
    motored = gas.motored_harmonics_at(engine.crank, MEAN)[0].real
    return np.asarray(np.divide(motored, fired, out=nothing, where=np.broadcast_to(fired != 0, nothing.shape)))
