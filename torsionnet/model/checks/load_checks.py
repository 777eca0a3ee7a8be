"""Checks that the load fits the drivetrain, its speeds and its operating point."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING

from torsionnet.core.errors import USELESS, Fault, Path, UsageError, unknown_name
from torsionnet.model.definition import Definition, all_nodes
from torsionnet.model.load.external_torques import CutOffError, ExternalTorques, stated_torques
from torsionnet.model.load.load_places import unknown_driver
from torsionnet.model.torque_places import torque_place

if TYPE_CHECKING:
    from torsionnet.model.load.load_section import Load

SAME_TORQUE_SHARE = 0.01
"""Relative difference up to which torques of the load and of the operating point agree, rounded as in data sheets."""


def unknown_in_load(definition: Definition, load: Load) -> Iterator[Fault]:
    """Faults of nodes and excitations that a load names and the model does not have."""
    nodes = all_nodes(definition.elements.values())
    single: Path = ("load", "absorbed_at")
    for place in load.by_place:
        path = ("load", "absorbers", place) if load.absorbers else single
        for node in torque_place(place).nodes:
            if node not in nodes:
                yield unknown_name("node", node, nodes, path, on_key=bool(load.absorbers))
    for name in load.driven_by:
        fault = unknown_driver(definition, name)
        if fault:
            yield Fault(fault, ("load", "driven_by", name), on_key=True)


def unfit_load(external: ExternalTorques) -> list[Fault]:
    """Faults of a load that does not turn with the drivetrain, has no rated speed or table row, or is contradicted."""
    definition = external.definition
    if definition.load is None:
        return []
    try:
        at = external.operating_speed
        torques = external.at_operating_point if at > 0 else external.at(abs(at))
        for speed in _extremes(definition):
            external.at(speed)
    except CutOffError as error:
        return [Fault(str(error), ("load",), "note", on_key=True, kind=USELESS)]
    except UsageError as error:
        return [Fault(str(error), ("load",), on_key=True)]
    if at < 0:
        text = f"with a load, {external.reference} turns in the positive sense: its mean speed must not be negative"
        return [Fault(text, ("operating_point", "speed"), on_key=True)]
    return list(_contradicted(external, torques, at))


def _extremes(definition: Definition) -> tuple[float, ...]:
    return (definition.speeds.values[0], definition.speeds.values[-1]) if definition.speeds else ()


def _contradicted(external: ExternalTorques, torques: Mapping[str, float], at: float) -> Iterator[Fault]:
    """Faults of stated torques that contradict the load, at single nodes or in the power driven in all."""
    stated = stated_torques(external.definition, external.values)
    apart = [node for node in stated if node in torques and not _agree(stated[node], torques[node])]
    for node in apart:
        text = f"the load gives {torques[node]:.6g} N*m here at this speed, the operating point {stated[node]:.6g} N*m"
        yield Fault(f"{text}; leave one of them out", ("operating_point", "torque", node))
    if not stated or apart:
        return
    speeds = {node: ratio * at for node, ratio in external.ratios.items()}
    driven, load = (
        sum(max(0.0, one * speeds.get(node, 0.0)) for node, one in side.items()) for side in (stated, torques)
    )
    if driven and not _agree(driven, load):
        text = (
            f"these torques drive with {driven / 1e3:.6g} kW, the load takes {load / 1e3:.6g} kW; leave one of them out"
        )
        yield Fault(text, ("operating_point", "torque"), on_key=True)


def _agree(first: float, second: float) -> bool:
    return abs(first - second) <= SAME_TORQUE_SHARE * max(abs(first), abs(second))
