"""Plants of periodic motions with reference numbers, each as a problem over frequency."""

from __future__ import annotations

from collections.abc import Sequence
from math import pi

import numpy as np

import torsionnet as tn
from torsionnet.motion.periodic.branch import MotionBranch, Tracer
from torsionnet.motion.periodic.condensed import CondensedPlant
from torsionnet.motion.periodic.periodic_problem import PeriodicDrive, PeriodicMotion, PeriodicProblem, peak_to_peak
from torsionnet.motion.periodic.starts import from_rest


def duffing() -> tn.Drivetrain:
    """Duffing's mass of NLvib, q'' + .05 q' + q + .1 q^3."""
    spring = tn.Spring("spring", nodes=("a", "ground"), stiffness=1, cubic=0.1, damping=0.05)
    return tn.Drivetrain("duffing", [tn.Inertia("mass", node="a", inertia=1), spring])


def two_stage_rig() -> tn.Drivetrain:
    """Test rig of a dual-mass flywheel whose springs have two stages, its secondary locked."""
    stages = [{"stiffness": "460 N*m/rad", "to": "0.12 rad"}, {"stiffness": "1500 N*m/rad"}]
    elements = [
        tn.Inertia("rotor", node="motor", inertia=0.078),
        tn.Damper("bearing", nodes=("motor", "ground"), damping=0.3),
        tn.Spring("meter", nodes=("motor", "primary"), stiffness=13300, damping=0.1),
        tn.Inertia("flywheel", node="primary", inertia=0.152),
        tn.Damper("support", nodes=("primary", "ground"), damping=0.3),
        tn.Spring("dmf", nodes=("primary", "ground"), stages=stages, damping=0.5),
    ]
    return tn.Drivetrain("two stages", elements, inputs={"T_M": {"torque": "motor"}})


def gear_pair(damping: float = 0.1) -> tn.Drivetrain:
    """Gear pair as one mass, x'' + c x' + f(x), with a dead zone of +-1."""
    mesh = tn.Clearance("mesh", nodes=("x", "ground"), gap=2, stiffness=1)
    damper = tn.Damper("damper", nodes=("x", "ground"), damping=damping)
    return tn.Drivetrain("gear pair", [tn.Inertia("mass", node="x", inertia=1), damper, mesh])


def rubbing_mass() -> tn.Drivetrain:
    """Mass on a spring with friction of 4 N m behind 300 N m/rad."""
    elements = [
        tn.Inertia("mass", node="x", inertia=0.05),
        tn.Spring("spring", nodes=("x", "ground"), stiffness=200, damping=0.15),
        tn.Friction("rub", nodes=("x", "ground"), torque=4, stiffness=300),
    ]
    return tn.Drivetrain("rubbing", elements)


def problem(
    rig: tn.Drivetrain, loads: dict[str, Sequence[complex]], at: float, *, hertz: bool = True
) -> PeriodicProblem:
    """Problem of a rig under torques with the harmonics given by node, over Hz or else over rad/s."""
    plant = CondensedPlant(rig, [tn.Input("torque", node) for node in loads])
    harmonics = np.array(list(loads.values()), dtype=complex).T
    factor = 2 * pi if hertz else 1.0
    return PeriodicProblem(plant, PeriodicDrive(lambda p: factor * p, lambda _: harmonics), at)


def branch_over(one: PeriodicProblem, start: float, end: float, harmonics: int = 20) -> MotionBranch:
    """MotionBranch from rest at the parameter ``start`` on, until it passes ``end``."""
    motion = next(iter(from_rest(one, start)))
    tracer = Tracer(one, harmonics)
    first = tracer.first(start, motion.x, np.sign(end - start))
    points = [first]
    for point in tracer.along(first, 600):
        points.append(point)
        if (point.p - end) * (end - start) > 0:
            break
    return MotionBranch(tracer, tuple(points), "from rest")


def swing(one: PeriodicProblem, motion: PeriodicMotion, law: int = 0) -> tuple[float, float]:
    """Lowest and highest twist of a law in rad."""
    return peak_to_peak(one.twists(motion.x, motion.torques)[:, law])
