"""Component of a model file from the loops of a test, with intervals: spring in stages, friction, clearance, arcs."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from torsionnet.drivetrain import Drivetrain
from torsionnet.model.elements import ArcSpring, Clearance, Friction, Lock, Spring
from torsionnet.signals.torque_loops.loop_numbers import ONE_FRICTION
from torsionnet.signals.torque_loops.loop_remarks import sides_differ
from torsionnet.signals.torque_loops.loop_result import LoopStage, LoopValue, TorqueLoop, TorqueLoops
from torsionnet.signals.torque_loops.loops import ARC, RADIUS, ArcLoops, arc_loops

NODES = ("driving", "driven")
DIGITS = 6


def write_loop_element(loops: TorqueLoops, path: str | Path) -> None:
    """Write the component that the largest loop of a test shows as a model file."""
    loop_element(loops).to_yaml(path)


def loop_element(loops: TorqueLoops) -> Drivetrain:
    """Component that the largest loop of a test shows, with its driven side clamped.

    Values are parameters, whose descriptions have interval and source. Where drive and coast have the same stages,
    within their intervals, the spring has their means, behind free play with a single stage a clearance; else rows of
    torque over twist, which hold for either side.
    """
    loop = max(loops.loops, key=lambda loop: loop.amplitude.value)
    source = f"{loop.cycles} cycles of {loops.torque} over {loops.twist}" + (
        f" in {loops.title}" if loops.title else ""
    )
    parameters: dict[str, Any] = {}

    def parameter(name: str, value: LoopValue, unit: str) -> str:
        half = "" if value.half_width is None else f" +- {value.half_width:.2g} {unit} (95 %)"
        text = f"{value.value:.{DIGITS}g} {unit}".rstrip()
        parameters[name] = {"value": text, "description": f"{text}{half}, {source}"}
        return name

    arcs = arc_loops(loops.loops)
    if arcs is not None:
        elements: list[Any] = [_arc_springs(arcs, loop, parameter, parameters), Lock("clamp", node=NODES[1])]
        return Drivetrain("component", elements, parameters=parameters, description=f"From loops: {source}")
    both = loop.side("both")
    if loop.side("drive") and loop.side("coast") and sides_differ(loop):
        spring: Any = Spring("springs", nodes=NODES, torque_over_twist=_spring_line_rows(loop))
    elif loop.free_play is not None and len(both) == 1:
        gap, stiffness = parameter("gap", loop.free_play, "rad"), parameter("k_1", both[0].stiffness, "N*m/rad")
        spring = Clearance("contact", nodes=NODES, gap=gap, stiffness=stiffness)
    elif both and loop.free_play is None:
        spring = Spring("springs", nodes=NODES, stages=_stages(both, parameter))
    else:
        spring = Spring("springs", nodes=NODES, torque_over_twist=_spring_line_rows(loop))
    elements = [spring, Lock("clamp", node=NODES[1])]
    if loop.friction.value > 0 and (loop.friction.half_width or 0.0) < loop.friction.value:
        torque = parameter("M", loop.friction, "N*m")
        each = [one.friction.value for one in both]
        if each and np.ptp(each) > ONE_FRICTION * max(each):
            parameters["M"]["description"] += ", its mean; stages rub with " + ", ".join(f"{one:.3g}" for one in each)
        elements.insert(1, Friction("friction", nodes=NODES, torque=torque))
    return Drivetrain("component", elements, parameters=parameters, description=f"From loops: {source}")


def _arc_springs(arcs: ArcLoops, loop: TorqueLoop, parameter: Any, parameters: dict[str, Any]) -> ArcSpring:
    """Arc springs about the mean torque, swing and speed of the largest loop, with what is assumed said."""

    def assumed(name: str, text: str, why: str) -> str:
        parameters[name] = {"value": text, "description": f"{text}, assumed: {why}"}
        return name

    psi = assumed("psi", f"{ARC:g} rad", "loops tell mu psi and m r^2/psi alone")
    radius = assumed("r", f"{RADIUS:g} m", "loops tell m r^2/psi alone")
    k = parameter("k", arcs.stiffness, "N*m/rad")
    told = "k mu psi is {:.{}g} N m/rad".format(arcs.product.value, DIGITS)
    if arcs.winding.half_width is None:
        parameters["k"]["description"] += f"; {told}, of which no loop tells k from mu psi"
        mu = assumed("mu", f"{arcs.winding.value / ARC:.{DIGITS}g}", "loops do not tell it from k")
    else:
        mu = parameter("mu", _scaled(arcs.winding, 1 / ARC), "")
    mass = (
        assumed("m", f"{arcs.pressing.value * ARC / RADIUS**2:.{DIGITS}g} kg", "loops at two speeds would show it")
        if arcs.pressing.half_width is None
        else parameter("m", _scaled(arcs.pressing, ARC / RADIUS**2), "kg")
    )
    point = (loop.speed or 0.0, "rad/s"), (loop.mean_torque, "N*m"), (loop.amplitude.value, "rad")
    speed, torque, swing = (f"{value:.{DIGITS}g} {unit}" for value, unit in point)
    return ArcSpring(
        "springs", nodes=NODES, stiffness=k, arc_angle=psi, friction_coefficient=mu, spring_mass=mass,
        spring_radius=radius, speed=speed, torque=torque, swing=swing,
    )  # fmt: skip


def _scaled(value: LoopValue, factor: float) -> LoopValue:
    return LoopValue(factor * value.value, None if value.half_width is None else factor * value.half_width)


def _stages(stages: Sequence[LoopStage], parameter: Any) -> list[Any]:
    """Entries of stages, each up to where the next one begins."""
    entries: list[dict[str, str]] = []
    for stage in stages:
        if stage.begins is not None:
            entries[-1]["to_twist"] = parameter(f"g_{stage.number - 1}", stage.begins, "rad")
        entries.append({"stiffness": parameter(f"k_{stage.number}", stage.stiffness, "N*m/rad")})
    return entries


def _spring_line_rows(loop: TorqueLoop) -> list[list[str]]:
    """Rows of twist and torque at the ends and breaks of a spring line, and at no twist, where its sides meet."""
    begins = [
        sign * stage.begins.value
        for side, sign in (("drive", 1), ("coast", -1))
        for stage in loop.side(side)
        if stage.begins is not None
    ]
    inside = [at for at in (0.0, *begins) if loop.twist[0] < at < loop.twist[-1]]
    twists = np.array(sorted({float(loop.twist[0]), *inside, float(loop.twist[-1])}))
    torques = np.interp(twists, loop.twist, loop.spring_line)
    return [
        [f"{twist:.{DIGITS}g} rad", f"{torque:.{DIGITS}g} N*m"] for twist, torque in zip(twists, torques, strict=True)
    ]
