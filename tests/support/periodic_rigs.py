"""Plants of periodic motions with reference numbers, each as a problem over frequency."""

from __future__ import annotations

from collections.abc import Sequence
from math import pi

import numpy as np

import torsionnet as tn
from torsionnet.model.channels import Input
from torsionnet.motion.periodic.all_branches import from_rest
from torsionnet.motion.periodic.branch import MotionBranch, Tracer
from torsionnet.motion.periodic.condensed import CondensedPlant
from torsionnet.motion.periodic.periodic_problem import PeriodicDrive, PeriodicMotion, PeriodicProblem, peak_to_peak


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


def free_clearance() -> tn.Drivetrain:
    """Two free masses with a clearance of 2 deg and a damper in it."""
    elements = [
        tn.Inertia("one", node="a", inertia=0.12),
        tn.Inertia("two", node="b", inertia=0.9),
        tn.Clearance("gap", nodes=("a", "b"), gap="2 deg", stiffness=8000),
        tn.Damper("oil", nodes=("a", "b"), damping=3),
    ]
    return tn.Drivetrain("free clearance", elements)


def car(**more: object) -> tn.Drivetrain:
    """Free driveline of a car, its dual-mass flywheel in two stages."""
    stages = [{"stiffness": "900 N*m/rad", "to": "0.08 rad"}, {"stiffness": "9000 N*m/rad"}]
    elements = [
        tn.Inertia("crank", node="engine", inertia=0.16),
        tn.Inertia("flange", node="secondary", inertia=0.055),
        tn.Inertia("gears", node="gearbox", inertia=0.018),
        tn.Inertia("body", node="vehicle", inertia=4.2),
        tn.Spring("dmf", nodes=("engine", "secondary"), stages=stages, damping=1.2),
        tn.Spring("shaft", nodes=("secondary", "gearbox"), stiffness=9000, damping=0.6),
        tn.Spring("driveshaft", nodes=("gearbox", "vehicle"), stiffness=420, damping=2.5),
    ]
    return tn.Drivetrain("car", elements, **more)


def sink(damping: float = 0.2) -> tn.Drivetrain:
    """Mass on a spring with a small one on a cubic spring, of 0.1 and 0.001 g + 0.4/3 g^3, which takes energy from it."""
    elements = [
        tn.Inertia("mass", node="a", inertia=1),
        tn.Spring("hold", nodes=("a", "ground"), stiffness=1),
        tn.Inertia("sink", node="b", inertia=0.1),
        tn.Spring("link", nodes=("a", "b"), stiffness=0.001, cubic=0.4 / 3, damping=0.1 * damping),
    ]
    return tn.Drivetrain("sink", elements)


CAR_LOADS = {"engine": [60, 300, -60j], "vehicle": [-60, 0, 0]}
"""Torques 60 + 300 cos 2 phi + 60 sin 4 phi of the engine, and the mean of the vehicle, by order 2."""


def order_2(rpm: float) -> float:
    """Frequency of order 2 in Hz at a speed in rpm."""
    return rpm / 30


def problem(
    rig: tn.Drivetrain, loads: dict[str, Sequence[complex]], at: float, *, hertz: bool = True
) -> PeriodicProblem:
    """Problem of a rig under torques with the harmonics given by node, over Hz or else over rad/s."""
    plant = CondensedPlant(rig, [Input("torque", node) for node in loads])
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
