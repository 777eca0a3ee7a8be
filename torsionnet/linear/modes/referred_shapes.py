"""Mode shapes with all angles referred to one shaft, as is usual for geared drivetrains."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from torsionnet.base.errors import UsageError, did_you_mean
from torsionnet.linear.assembly.assembled import AssembledModel
from torsionnet.linear.modes.eigen import unit_shapes
from torsionnet.linear.modes.modes import Modes
from torsionnet.model.element_base.speed_path import SpeedPaths
from torsionnet.model.elements import Values


def referred_shapes(drivetrain: AssembledModel, modes: Modes, referred_to: str) -> Modes:
    """Modes with angles times speed of a shaft over speed of the node, scaled to a largest angle of 1.

    Nodes to which no ratio leads, as a block on its mounts, keep their own angles; a note names them.

    Raises
    ------
    UsageError
        There is no such node.

    Examples
    --------
    >>> import torsionnet as tn
    >>> rig = tn.load("amt_rig").configured("V")
    >>> shapes = referred_shapes(rig, rig.modes(), "motor")
    >>> bool(abs(shapes.shape_at("input_shaft")[0] - shapes.shape_at("output_shaft")[0]) < 1e-12)
    True
    """
    if referred_to not in drivetrain.nodes:
        raise UsageError(f'no node is named "{referred_to}"{did_you_mean(referred_to, drivetrain.nodes)}')
    value = Values(drivetrain.exact_values)
    paths = SpeedPaths(tuple(drivetrain.elements.values()), value)
    found = {node: paths.between(node, referred_to) for node in modes.nodes}
    factors = np.array([1.0 if path is None else float(path.ratio(value)) for path in found.values()])
    own = [node for node, path in found.items() if path is None]
    notes = (f"angles referred to {referred_to}", *([f"no ratio leads there from {', '.join(own)}"] if own else []))
    return replace(
        modes,
        shapes=np.asarray(unit_shapes(modes.shapes * factors[:, None]), dtype=complex),
        notes=(*modes.notes, *notes),
    )
