"""Responses to excitation by orders: one solution at all frequencies that occur, then sums over what acts there."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from fractions import Fraction
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from torsionnet.assembly.assembled import AssembledModel
from torsionnet.core.errors import UsageError, meant_or
from torsionnet.model.channels import Input, Sensor
from torsionnet.model.excitations import OrderExcitation
from torsionnet.model.speeds import total_ratio
from torsionnet.response.frequency_response import ComplexArray, FloatArray
from torsionnet.response.order_response import OrderLine, OrderResponse
from torsionnet.solve.operating_groups import Places, over_operating_points
from torsionnet.solve.transfer import frequency_response

TOGETHER = 500
"""Speeds that are solved together, which bounds the memory."""


def order_response(
    drivetrain: AssembledModel,
    outputs: str | Sensor | Sequence[str | Sensor],
    *,
    speeds: ArrayLike | None = None,
    speed_of: str | None = None,
    excitations: Iterable[str] | None = None,
) -> OrderResponse:
    """See :meth:`torsionnet.Drivetrain.order_response`."""
    reference, at = _speeds(drivetrain, speeds, speed_of)
    acting = _acting(drivetrain.definition.excitations, excitations)
    for name, one in acting.items():
        _require_moving(drivetrain, name, one)
    ratios = {name: _ratio(drivetrain, one.shaft, reference) for name, one in acting.items()}
    blocks: list[OrderResponse] = []

    def amplitudes(rig: AssembledModel, places: Places) -> ComplexArray:
        blocks[:] = [_block(rig, outputs, acting, ratios, reference, part) for part in _parts(at[places])]
        return np.concatenate([block.values for block in blocks])

    values = over_operating_points(drivetrain, reference, at, amplitudes)
    return replace(blocks[0], speeds=at, values=values)


def _parts(at: FloatArray) -> list[FloatArray]:
    """Speeds that are solved together."""
    return [at[start : start + TOGETHER] for start in range(0, len(at), TOGETHER)]


def _block(
    drivetrain: AssembledModel,
    outputs: str | Sensor | Sequence[str | Sensor],
    acting: Mapping[str, OrderExcitation],
    ratios: Mapping[str, Fraction],
    reference: str,
    at: FloatArray,
) -> OrderResponse:
    """The responses at some speeds."""
    torques = {name: one.torques(at * abs(float(ratios[name]))) for name, one in acting.items()}
    nodes = tuple(dict.fromkeys(node for found in torques.values() for node in found.nodes))
    lines = [
        (OrderLine(name, float(order), abs(ratios[name])), place)
        for name, found in torques.items()
        for place, order in enumerate(found.orders)
    ]
    relative = np.array([float(line.relative) for line, _ in lines])
    frequencies, where = np.unique(at[:, None] * relative / (2 * math.pi), return_inverse=True)
    torques_on: list[Any] = [Input("torque", node) for node in nodes]
    response = frequency_response(drivetrain, outputs, torques_on, frequencies)
    # A torque drives the shaft it is on, whichever way that turns.
    signs = {node: math.copysign(1, _ratio(drivetrain, node, reference)) for node in nodes}
    loads = np.zeros((len(at), len(lines), len(nodes)), dtype=complex)
    for number, (line, place) in enumerate(lines):
        found = torques[line.excitation]
        for column, node in enumerate(found.nodes):
            loads[:, number, nodes.index(node)] += signs[node] * found.amplitudes[:, place, column]
    values = np.einsum("slon,sln->slo", response.values[where.reshape(len(at), len(lines))], loads)
    return OrderResponse(at, reference, tuple(line for line, _ in lines), values, response.outputs, drivetrain.title)


def _require_moving(drivetrain: AssembledModel, name: str, excitation: OrderExcitation) -> None:
    """Refuse an excitation on what is locked or switched off in this configuration."""
    for node in excitation.nodes:
        if node not in drivetrain.nodes:
            raise UsageError(f'{name} acts on "{node}", to which nothing is attached in this configuration')
        if drivetrain.assembly.kinematics.holds(node):
            raise UsageError(
                f'{name} acts on "{node}", which is locked in this configuration; nothing would come of it'
            )


def _speeds(drivetrain: AssembledModel, speeds: ArrayLike | None, speed_of: str | None) -> tuple[str, FloatArray]:
    """The reference node and its speeds in rad/s."""
    given = drivetrain.definition.speeds
    if given is None and (speeds is None or speed_of is None):
        raise UsageError("the model has no entry speeds: {of: node, range: 300..800 rpm, step: 5 rpm}")
    reference = str(speed_of or (given and given.of))
    at = np.atleast_1d(np.asarray(speeds if speeds is not None else given and given.values, dtype=float))
    if at.ndim != 1 or not len(at) or not np.isfinite(at).all() or (at <= 0).any():
        raise UsageError("speeds are finite numbers above 0, in rad/s")
    return reference, at


def _acting(known: Mapping[str, OrderExcitation], names: Iterable[str] | None) -> dict[str, OrderExcitation]:
    if not known:
        raise UsageError("the model has no excitations; what runs in it stands in its entry excitations:")
    chosen = list(known) if names is None else [names] if isinstance(names, str) else list(names)
    for name in chosen:
        if name not in known:
            hint = meant_or(name, known, f"there are {', '.join(known)}")
            raise UsageError(f'no excitation is named "{name}"{hint}')
    return {name: known[name] for name in chosen}


def _ratio(drivetrain: AssembledModel, node: str, reference: str) -> Fraction:
    ratio = total_ratio(drivetrain.definition, drivetrain.exact_values, node, reference)
    if not ratio:
        raise UsageError(f"{node} does not turn when {reference} does")
    return ratio
