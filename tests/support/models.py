"""Small drivetrains that several tests use, built through the public API."""

from pathlib import Path

import torsionnet as tn
from torsionnet.base.errors import UsageError
from torsionnet.base.expressions import Algebra
from torsionnet.linear.assembly.law_stiffness import functional

SHEET = Path(__file__).parents[1] / "sheets" / "line.csv"

EVERY_ELEMENT = {
    "inertia": tn.Inertia("e", node="a", inertia=2),
    "spring": tn.Spring("e", nodes=("a", "b"), stiffness=300, damping=5),
    "clearance": tn.Clearance("e", nodes=("a", "b"), gap=0.01, stiffness=300, damping=5),
    "friction": tn.Friction("e", nodes=("a", "b"), torque=20, stick=30, stiffness=400),
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
    "continuous_shaft": tn.ContinuousShaft(
        "e", nodes=("a", "b"), outer_diameter=0.05, inner_diameter=0.02, length=1.2, loss_factor={"zeta": 0.01}
    ),
    "propeller": tn.Propeller("e", node="a", inertia=2, entrained_water=0.25, archer=30, torque=200, speed=15),
    "fluid_coupling": tn.FluidCoupling(
        "e", pump="a", turbine="b", speed=150, speed_ratio=0.97, k_factor=[[0.9, 30], [0.99, 90]],
        pump_inertia=0.2, turbine_inertia=0.1, housing="c",
    ),
    "torque_converter": tn.TorqueConverter(
        "e", pump="a", turbine="b", speed=150, speed_ratio=0.6, performance=[[0, 0.04], [1, 0.02]], diameter=0.26,
        torque_ratio=[[0, 2.1], [0.9, 1]], pump_inertia=0.2, turbine_inertia=0.1, housing="c",
    ),
    "controller": tn.Controller(
        "e", sense={"velocity": ["a", "b"]}, act=["c", "b"], law={"p": -3, "i": -5, "d": 1, "filter": 0.2}, delay=0.1
    ),
    "lumped_matrices": tn.LumpedMatrices(
        "e", nodes=("a", "b"), inertia=[[2, 0.5], [0.5, 1]], damping=[[2, -2], [-2, 2]], stiffness=[[300, -300], [-300, 300]]
    ),
    "synchronous_machine": tn.SynchronousMachine(
        "e", node="a", housing="b", pull_out_torque=500, torque=300, pole_pairs=2, damping=7, inertia=0.6
    ),
    "induction_machine": tn.InductionMachine(
        "e",
        node="a",
        housing="b",
        synchronous_speed=150,
        breakdown_torque=400,
        rated_torque=180,
        rated_slip=0.02,
        time_constant=0.03,
        inertia=0.4,
    ),
    "grid_generator": tn.GridGenerator(
        "e",
        node="a",
        grid="b",
        rated_power=2e4,
        speed=150,
        grid_frequency="71.6197 Hz",
        inertia_constant=0.8,
        emf=1.3,
        grid_voltage=1,
        reactance=0.6,
        power=0.5,
        damping_coefficient=9,
    ),
    "constant_power_load": tn.ConstantPowerLoad("e", node="a", housing="b", power=900, speed=50),
    "crank_throw": tn.CrankThrow(
        "e",
        nodes=("a", "b"),
        inertia=0.3,
        crank_radius=0.06,
        rotating_mass=1.2,
        reciprocating_mass=1.6,
        rod_length=0.2,
        stiffness=800,
        damping=2,
        cylinder_damping=1,
    ),
    "viscous_damper": tn.ViscousDamper("e", node="a", ring_inertia=3, damping=5, stiffness=200, hub_inertia=0.5),
    "tuned_damper": tn.TunedDamper(
        "e", node="a", ring_inertia=3, natural_frequency=1.5, damping_ratio=0.1, hub_inertia=0.5
    ),
    "spring_damper": tn.SpringDamper(
        "e",
        node="a",
        ring_inertia=3,
        stiffness=200,
        damping={"eta": 0.3, "at": "2 Hz"},
        hub_inertia=0.2,
    ),
    "pendulum_absorber": tn.PendulumAbsorber(
        "e", node="a", mass=4, pivot_radius=0.5, path_radius=0.2, speed=9, count=2, own_inertia=0.1, damping=0.3
    ),
    "arc_spring": tn.ArcSpring(
        "e",
        nodes=("a", "b"),
        stiffness=200,
        arc_angle=2.6,
        friction_coefficient=0.1,
        spring_mass=0.9,
        spring_radius=0.1,
        speed=150,
        torque=90,
        swing=0.02,
        damping=1,
    ),
    "dual_mass_flywheel": tn.DualMassFlywheel(
        "e",
        nodes=("a", "b"),
        primary_inertia=2,
        secondary_inertia=1,
        stages=[{"stiffness": 200, "to": "30 N*m"}, {"stiffness": 400}],
        torque=50,
        blocked=0.2,
        damping=1,
    ),
    "flexible_coupling": tn.FlexibleCoupling(
        "e",
        nodes=("a", "b"),
        stiffness_over_torque={0: 200, 1: 500},
        T_KN=100,
        torque=40,
        temperature="60 degC",
        temperature_factor={"20 degC": 1, "100 degC": 0.5},
        damping=4,
        in_series=2,
        first_inertia=0.5,
    ),
    "clutch": tn.Clutch(
        "e", nodes=("a", "b"), state="slipping", slip_speed=5, friction=[[0, 0.1], [20, 0.14]], clamp_torque=900,
        stiffness=700, damping=2, first_inertia=0.2, disc_inertia=0.1,
    ),
    "gearbox": tn.Gearbox(
        "e", input="a", output="b", ratios={"I": -4, "II": -2.5, "III": 1.2}, engaged="II", housing="c",
        wheel_inertias={"I": 0.3, "II": 0.2}, input_inertia=0.1, output_inertia=0.2, stiffness={"II": 5e3, "III": 4e3},
        damping=3,
    ),
    "final_drive": tn.FinalDrive(
        "e", pinion="a", left="b", right="c", teeth=(20, -71), differential="limited-slip", slip_damping=20,
        pinion_inertia=0.1, cage_inertia=0.3, stiffness=9e3, damping=2, housing="d",
    ),
    "vehicle": tn.Vehicle(
        "e", node="a", mass=1500, wheel_radius=0.3, wheel_inertia=2, speed=20, drag_area=0.6, rolling_slope=1e-4
    ),
    "tyre": tn.Tyre(
        "e", nodes=("a", "b"), radius=0.3, slip_stiffness=800, speed=9, relaxation_length=0.4, damping=3, belt_inertia=0.3
    ),
    "belt": tn.Belt(
        "e", pulleys={"a": 0.1, "b": 0.05, "c": -0.04}, stiffness=[3e4, 2e4, 4e4], damping=3, pretension=300,
        tensioner="c", arm="d", levers=[0.06, 0.04], housing="f",
    ),
    "chain_drive": tn.ChainDrive(
        "e", sprockets={"a": 20, "b": 31}, pitch=0.0127, axial_stiffness=1e5, lengths=[0.3, 0.4], damping=2, housing="c"
    ),
    "mass_elastic": tn.MassElastic("e", table=SHEET, at={"first": "a", "last": "b"}),
}  # fmt: skip


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
    sensors = {}
    for one in element.expanded():
        mark = one.name.removeprefix("e").replace(".", "_")
        sensors[f"twist{mark}"] = {"twist": one.name}
        sensors |= {f"T_{port}{mark}": {"torque": one.name, "at": port} for port in one.ports}
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


def sympy_algebra():
    """Exact numbers of sympy, for values with symbols in them."""
    import sympy

    return Algebra(number=lambda x: sympy.Rational(x.numerator, x.denominator), sqrt=sympy.sqrt, pi=sympy.pi)
