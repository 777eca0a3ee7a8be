"""Check that the mean torques of the operating point are in balance."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from torsionnet.core.errors import Fault
from torsionnet.model.checks.motions import free_motions
from torsionnet.model.kinematics import Kinematics
from torsionnet.model.load.external_torques import UNBALANCED_SHARE, ExternalTorques


def unbalanced_torques(external: ExternalTorques, kinematics: Kinematics) -> list[Fault]:
    """Warnings about mean torques out of balance on a part that turns freely, as a load with the sign of a drive.

    Springs hand mean torques on and dampers stand for vibration, so neither takes any. A single torque is half of what
    acts there, and says nothing. Those of a load are in balance as a whole: what is left on one part is an error. Laws
    of motion take torques too, so that their operating point tells what is left.
    """
    definition = external.definition
    if any(element.has_motion_laws for element in definition.switched_on):
        return []
    acting = external.at_operating_point
    given = {node: torque for node, torque in acting.items() if torque and node in kinematics.nodes}
    if len(given) < 2:
        return []
    fewest = 2 if definition.load is None else 1
    left = free_motions(kinematics, lambda law: law.is_elastic)
    work: dict[str, dict[str, float]] = {}
    for node, torque in given.items():
        for motion, ratio in left.in_floats({node: 1}).items():
            work.setdefault(motion, {})[node] = torque * ratio
    faults = [fault for done in work.values() if len(done) >= fewest for fault in _unbalanced(given, done)]
    if definition.load is None:
        return faults
    return [replace(fault, path=("load",), severity="error") for fault in faults]


def _unbalanced(given: Mapping[str, float], done: Mapping[str, float]) -> list[Fault]:
    """Warning that mean torques do net work on one rigid motion of the drivetrain.

    ``done`` is the work of each torque.
    """
    rest, largest = sum(done.values()), max(map(abs, done.values()))
    if abs(rest) <= UNBALANCED_SHARE * largest:
        return []
    last = list(done)[-1]
    over = rest * given[last] / done[last]
    listed = ", ".join(f"{node} {given[node]:.6g} N*m" for node in done)
    turned = [node for node in done if abs(rest - 2 * done[node]) <= UNBALANCED_SHARE * largest]
    hint = f'; did you mean "{turned[-1]}: {-given[turned[-1]]:.6g} N*m"?' if turned else ""
    text = (
        f"the mean torques ({listed}) leave {over:.4g} N*m over at {last}, and a load acts against the rotation{hint}"
    )
    return [Fault(text, ("operating_point", "torque"), "warning", on_key=True)]
