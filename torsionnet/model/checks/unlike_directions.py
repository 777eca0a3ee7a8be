"""Mean torques that act the wrong way: an engine that is driven, a propeller that drives."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from torsionnet.core.errors import Fault
from torsionnet.core.units import RPM
from torsionnet.model.elements.propeller import Propeller
from torsionnet.model.load.external_torques import ExternalTorques, stated_torques


def unlike_directions(external: ExternalTorques) -> Iterator[Fault]:
    """Warnings about torques of the operating point whose power is that of a consumer at an engine, or the opposite."""
    speeds, definition = external.mean_speeds, external.definition
    expected: dict[str, tuple[str, bool]] = {}
    for name, one in definition.excitations.items():
        if one.enabled and one.rating is not None and one.rating.torque:
            expected |= dict.fromkeys((*one.nodes, one.shaft), (name, one.rating.torque > 0))
    expected |= {str(one.node): (one.name, False) for one in definition.active if isinstance(one, Propeller)}
    for node, torque in stated_torques(definition, external.values).items():
        if node in expected and torque * speeds.get(node, 0.0):
            yield from _wrong_way(node, torque, speeds, *expected[node])


def _wrong_way(node: str, torque: float, speeds: Mapping[str, float], name: str, drives: bool) -> Iterator[Fault]:
    if (torque * speeds[node] > 0) == drives:
        return
    sense = "in" if torque * speeds[node] > 0 else "against"
    text = f"{torque:.6g} N*m act {sense} the rotation of {node}, {speeds[node] * RPM:.6g} rpm"
    text += f", but {name} {'drives' if drives else 'takes power'} there; did you mean {-torque:.6g} N*m?"
    yield Fault(text, ("operating_point", "torque", node), "warning")
