"""Small drivetrains that several tests use, built through the public API."""

from pathlib import Path

import torsionnet as tn
from torsionnet.assembly.functionals import functional
from torsionnet.core.errors import UsageError

SHEET = Path(__file__).parent / "sheets" / "line.csv"

EVERY_ELEMENT = {
    "inertia": tn.Inertia("e", node="a", inertia=2),
    "spring": tn.Spring("e", nodes=("a", "b"), stiffness=300, damping=5),
    "damper": tn.Damper("e", nodes=("a", "b"), damping=5),
    "hysteretic_spring": tn.HystereticSpring("e", nodes=("a", "b"), stiffness=300, loss_factor=0.2, damping=1),
    "tabulated_spring": tn.TabulatedSpring("e", nodes=("a", "b"), table=[[1, 300, 2], [9, 500, 1]]),
    "gear": tn.Gear("e", nodes=("a", "b"), teeth=(20, -37), stiffness=1e4, damping=3, housing="c"),
    "planetary": tn.Planetary(
        "e", sun="a", ring="b", carrier="c", teeth=(30, 72), planet_inertia=0.1, planet_mass=2, orbit_radius=0.3
    ),
    "differential": tn.Differential("e", cage="a", left="b", right="c"),
    "rigid_coupling": tn.RigidCoupling("e", nodes=("a", "b")),
    "lock": tn.Lock("e", node="a"),
    "shaft": tn.Shaft(
        "e", nodes=("a", "b"), outer_diameter=0.05, inner_diameter=0.02, length=1.2, segments=3, damping=4
    ),
    "propeller": tn.Propeller("e", node="a", inertia=2, entrained_water=0.25, archer=30, torque=200, speed=15),
    "viscous_damper": tn.ViscousDamper("e", node="a", ring_inertia=3, damping=5, stiffness=200, hub_inertia=0.5),
    "mass_elastic": tn.MassElastic("e", table=SHEET, at={"first": "a", "last": "b"}),
}


def geared_line(**changes):
    """Motor - torque meter - spring - gear - spring - clamp, with every kind of sensor."""
    parameters = {"J_1": 0.2, "J_2": 0.5, "k_1": 900, "k_2": "4 kN*m/rad", "tau": 3, "c": 2} | changes
    return tn.Drivetrain(
        "geared line",
        [
            tn.Inertia("motor", node="m", inertia="J_1"),
            tn.RigidCoupling("meter", nodes=("m", "p")),
            tn.Spring("soft", nodes=("p", "g"), stiffness="k_1", damping="c"),
            tn.Inertia("wheel", node="g", inertia="J_2"),
            tn.Gear("stage", nodes=("g", "o"), ratio="tau"),
            tn.Spring("stiff", nodes=("o", "h"), stiffness="k_2"),
            tn.Lock("brake", node="h"),
        ],
        parameters=parameters,
        inputs={"T_M": {"torque": "m"}},
        sensors={"angle": {"angle": "m"}, "T": {"torque": "meter"}},
    )


def around(element):
    """A drivetrain that needs the element: inertias and springs on its nodes, every sensor it can have."""
    nodes = [node for node in element.ports.values() if node != "ground"]
    parts = [tn.Inertia(f"j_{node}", node=node, inertia=1 + i) for i, node in enumerate(nodes)]
    parts += [tn.Spring(f"s_{n}", nodes=(n, "ground"), stiffness=100 + 30 * i) for i, n in enumerate(nodes)]
    sensors = {"twist": {"twist": "e"}}
    sensors |= {f"T_{port}": {"torque": "e", "at": port} for port in element.ports}
    sensors |= {f"w_{node}": {"velocity": node} for node in nodes} | {"a": {"acceleration": nodes[-1]}}
    sensors |= {f"inside_{index}": {"angle": node} for index, node in enumerate(element.internal_nodes)}
    parts += [
        tn.Inertia("j_x", node="x", inertia=0.7),
        tn.Spring("s_x", nodes=("x", nodes[0]), stiffness=70, damping=2),
    ]
    return tn.Drivetrain("around", [*parts, element], inputs={"T": {"torque": "x"}}, sensors=sensors)


def without_indeterminate(rig):
    """Sensors of torques that no equation of statics gives are left out."""
    kept = {}
    for name, sensor in rig.sensors.items():
        try:
            functional(rig, sensor, name)
            kept[name] = sensor
        except UsageError:
            continue
    return tn.Drivetrain(rig.name, rig.elements, inputs=rig.inputs, sensors=kept)
