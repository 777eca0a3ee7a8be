"""Warnings about unstable modes, with the element that feeds each, for drivetrains that may be unstable."""

from __future__ import annotations

import math

import numpy as np

from torsionnet.base.errors import Fault, SolveError, UsageError, message_of, named_list
from torsionnet.base.phrases import ModelName, phrase
from torsionnet.linear.assembly.assembled import AssembledModel
from torsionnet.linear.modes.modes import Modes
from torsionnet.linear.modes.natural_modes import natural_modes

_CONTROLLER_ADVICE = "lower its gain or its delay; torsionnet margins MODEL shows by how much"
_NEGATIVE_DAMPING_ADVICE = "other damping has to exceed what it feeds, or its working point has to be another"


def unstable_modes(drivetrain: AssembledModel) -> tuple[Fault, ...]:
    """Warnings about every unstable mode of a drivetrain, at the element that feeds the mode most.

    Examples
    --------
    >>> import torsionnet as tn
    >>> push = tn.Controller("push", sense={"velocity": "a"}, act="a", law=2)
    >>> rig = tn.Drivetrain("one", [tn.Inertia("disc", node="a", inertia=1),
    ...     tn.Spring("shaft", nodes=("a", "ground"), stiffness=100), push])
    >>> print(unstable_modes(rig)[0].message)  # doctest: +ELLIPSIS
    push makes the mode at 1.592 Hz unstable, it grows: damping ratio -10 %; ...; lower its gain or its delay; ...
    """
    feeding = [element.name for element in drivetrain.elements.values() if element.may_feed]
    if not feeding:
        return ()
    try:
        modes, texts = natural_modes(drivetrain)
    except (UsageError, SolveError) as error:
        said = "whether {} leaves the drivetrain stable is not known: {}"
        text = phrase(said, named_list(feeding), message_of(error))
        return (Fault(text, ("elements", feeding[0]), "note", on_key=True),)
    warned = tuple(
        Fault(text, ("elements", feeding[0]), "warning", on_key=True, kind="unstable-drivetrain") for text in texts
    )
    growing = np.flatnonzero(modes.eigenvalues.real > 0)
    return (*(_growing(drivetrain, modes, int(mode), feeding) for mode in growing), *warned)


def _growing(drivetrain: AssembledModel, modes: Modes, mode: int, feeding: list[str]) -> Fault:
    # Who feeds a mode dissipates less than nothing.
    shares = modes.dissipated[:, mode]
    worst = modes.elements[int(np.argmin(shares))] if shares.min(initial=0.0) < 0 else feeding[0]
    value = complex(modes.eigenvalues[mode])
    words = modes.motions[mode]
    if value.imag == 0:
        text = phrase("{} makes the drivetrain unstable: its motion grows {}", ModelName(worst), words)
    else:
        ratio = 100 * float(modes.damping_ratios[mode])
        at = f"{abs(value) / (2 * math.pi):.4g} Hz"
        said = "{} makes the mode at {} unstable, it grows: damping ratio {:.3g} %; {}"
        text = phrase(said, ModelName(worst), at, ratio, words)
    acts = any(action.owner == worst for action in drivetrain.assembly.system.actions)
    instead = _CONTROLLER_ADVICE if acts else _NEGATIVE_DAMPING_ADVICE
    return Fault(
        phrase("{}; {}", text, instead), ("elements", worst), "warning", on_key=True, kind="unstable-drivetrain"
    )
