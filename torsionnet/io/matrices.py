"""Constant matrices of second order (M, C, K, inputs, outputs) of a drivetrain, as other programs take them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from torsionnet.base.errors import UsageError
from torsionnet.drivetrain import Drivetrain
from torsionnet.linear.assembly.law_stiffness import Functional, powers_of_s
from torsionnet.linear.assembly.rows import FloatArray, refuse_actions
from torsionnet.linear.assembly.system import Assembly
from torsionnet.linear.dynamic_stiffness.state_space import active_channels


@dataclass(frozen=True)
class Matrices:
    """Matrices of a drivetrain's equations of motion with inputs and outputs, in SI.

        M q'' + C q' + K q = F u,    y = Y0 q + Y1 q' + Y2 q'' + Yu u,    theta = T q

    Attributes
    ----------
    M, C, K : (n_q, n_q) arrays
        kg m^2, N m s/rad, N m/rad.
    F : (n_q, n_in) array
        Generalised torque of each input, 1.
    Y0, Y1, Y2 : (n_out, n_q) arrays
    Yu : (n_out, n_in) array
    T : (n_nodes, n_q) array
        Angles of all nodes from the coordinates.
    coordinates, nodes, inputs, outputs, input_units, output_units : tuple of str
    """

    M: FloatArray
    C: FloatArray
    K: FloatArray
    F: FloatArray
    Y0: FloatArray
    Y1: FloatArray
    Y2: FloatArray
    Yu: FloatArray
    T: FloatArray
    coordinates: tuple[str, ...]
    nodes: tuple[str, ...]
    inputs: tuple[str, ...]
    outputs: tuple[str, ...]
    input_units: tuple[str, ...]
    output_units: tuple[str, ...]


def matrices(drivetrain: Drivetrain) -> Matrices:
    """Matrices in SI of the equations of motion of a drivetrain, with its torque inputs and its sensors.

    Raises
    ------
    UsageError
        A stiffness that depends on frequency, or an input that imposes an angle.

    Examples
    --------
    >>> import torsionnet as tn
    >>> found = matrices(tn.load("dmf_rig"))
    >>> found.coordinates, found.K.tolist(), found.F.tolist()
    (('motor', 'primary'), [[13300.0, -13300.0], [-13300.0, 13760.0]], [[1.0], [0.0]])
    """
    assembly, system = drivetrain.assembly, drivetrain.assembly.system
    present = active_channels(drivetrain)
    _refuse(drivetrain, assembly)
    loads = [assembly.rows_of(channel.row)[0] for channel in present.inputs.values()]
    readings = present.readings(drivetrain)
    n, n_in = system.n_coordinates, len(loads)
    motion = np.array([_motion(assembly, reading) for reading in readings]).reshape(len(readings), 3, n)
    direct = [[float(reading.direct(channel.row)) for channel in present.inputs.values()] for reading in readings]
    return Matrices(
        system.M, system.C, system.K, np.array(loads).reshape(n_in, n).T, motion[:, 0], motion[:, 1], motion[:, 2],
        np.array(direct).reshape(len(readings), n_in), assembly.T, assembly.kinematics.coordinates, assembly.nodes,
        tuple(present.inputs), tuple(present.sensors), ("N*m",) * n_in, tuple(reading.unit for reading in readings),
    )  # fmt: skip


def _refuse(drivetrain: Drivetrain, assembly: Assembly) -> None:
    refuse_actions(assembly.system.actions, "constant matrices are")
    dynamic = sorted({assembly.owners[index] for index, _ in assembly.system.dynamic})
    if dynamic:
        raise UsageError(
            f"{', '.join(dynamic)}: a stiffness that depends on frequency has no place in constant matrices"
        )
    imposed = [name for name, channel in drivetrain.inputs.items() if channel.quantity != "torque"]
    if imposed:
        raise UsageError(
            f"{', '.join(imposed)} imposes an angle; constant matrices have only torques as inputs: make it one"
        )


def _motion(assembly: Assembly, reading: Functional) -> FloatArray:
    """Coefficients (3, n_q) in SI of q, q' and q'' in a sensor's reading."""
    found = np.zeros((3, assembly.system.n_coordinates))
    for term in reading.terms:
        factors = [float(factor) for factor in powers_of_s(assembly, term)]
        found += np.outer(factors, float(term.factor) * term.row)
    return found
