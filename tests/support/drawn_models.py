"""Drivetrains that are hard to draw: each one stresses one part of a schematic."""

import itertools
import random

import torsionnet as tn
from support.random_drivetrains import draw


def inertia(name, node, value=1.0):
    return tn.Inertia(name, node=node, inertia=value)


def hybrid():
    """Planetary set, differential, branches, a loop through the road, every kind of spring and sensor."""
    return tn.Drivetrain(
        "hybrid axle with a title in $",
        [
            inertia("engine", "e", 0.2),
            tn.Spring("damper_spring", nodes=("e", "s"), stiffness=600, damping={"zeta": 0.02, "at": "12 Hz"}),
            tn.Planetary("split", sun="s", ring="r", carrier="c", teeth=(30, 78), planet_inertia=1e-4),
            inertia("generator", "s", 0.05),
            inertia("ring_gear", "r", 0.02),
            tn.Gear("counter", nodes=("r", "k"), teeth=(30, -44)),
            tn.Gear("reduction", nodes=("k", "cage"), ratio=-3.5, stiffness=1e6, damping=10),
            tn.Gear("motor_gear", nodes=("m", "k"), ratio=-2.6),
            inertia("motor", "m", 0.03),
            tn.Differential("axle", cage="cage", left="l", right="rr"),
            tn.Shaft("left_shaft", nodes=("l", "wl"), outer_diameter="28 mm", length="0.6 m", segments=4),
            tn.Spring("right_shaft", nodes=("rr", "wr"), stiffness=9000),
            inertia("wheel_left", "wl", 0.9),
            inertia("wheel_right", "wr", 0.9),
            tn.HystereticSpring("tyre_left", nodes=("wl", "road"), stiffness=3e4, loss_factor=0.1),
            tn.TabulatedSpring("tyre_right", nodes=("wr", "road"), table=[[1, 3e4, 2], [20, 4e4, 1]]),
            inertia("vehicle", "road", 130),
            tn.Damper("drag", nodes=("road", "ground"), damping=3),
            tn.Lock("carrier_brake", node="c"),
            tn.Damper("oil", nodes=("k", "ground"), damping=0.1),
            tn.Spring("mount", nodes=("m", "ground"), stiffness=5),
            tn.Spring("pto_shaft", nodes=("e", "pump"), stiffness=800),
            inertia("pump_inertia", "pump", 0.01),
        ],
        inputs={"T_E": {"torque": "e"}, "T_mot": {"torque": "m"}},
        sensors={
            "w_e": {"velocity": "e"},
            "T_left": {"torque": "left_shaft"},
            "T_cage": {"torque": "reduction", "at": "cage"},
            "T_brake": {"torque": "carrier_brake"},
            "twist": {"twist": "right_shaft"},
        },
    )


def parallel():
    """Gears side by side, strands side by side, an elastic end, and a loop of gears."""
    return tn.Drivetrain(
        "side by side",
        [
            inertia("a", "x"),
            tn.Gear("g1", nodes=("x", "y"), ratio=3, stiffness=1e4),
            tn.Gear("g2", nodes=("x", "y"), ratio=2.9, stiffness=1e5),
            inertia("b", "y", 20),
            tn.Spring("p1", nodes=("y", "z"), stiffness=4),
            tn.Spring("p2_with_a_long_name", nodes=("y", "z"), stiffness=4, damping=2),
            tn.Damper("p3", nodes=("z", "y"), damping=2),
            tn.Damper("across", nodes=("x", "z"), damping=2),
            inertia("e", "z"),
            tn.Spring("wall", nodes=("z", "ground"), stiffness=3, damping=1),
        ],
    )


def chain(count):
    masses = [inertia(f"J{i}", f"n{i}", 1 + i % 7) for i in range(count)]
    springs = [tn.Spring(f"k{i}", nodes=(f"n{i}", f"n{i + 1}"), stiffness=1e4) for i in range(count - 1)]
    return tn.Drivetrain(f"chain of {count}", [*masses, *springs, tn.Lock("end", node=f"n{count - 1}")])


def star():
    arms = [
        element
        for i in range(6)
        for element in (
            tn.Gear(f"g_{i}", nodes=("h", f"p{i}"), ratio=-2 - i),
            tn.Spring(f"k_{i}", nodes=(f"p{i}", f"q{i}"), stiffness=9),
            inertia(f"J_{i}", f"q{i}"),
        )
    ]
    return tn.Drivetrain("star", [inertia("hub", "h"), *arms])


def ends_clamped():
    middle = [tn.Spring(f"k_{i}", nodes=(f"n{i}", f"n{i + 1}"), stiffness=i + 1) for i in range(9)]
    masses = [inertia(f"J_{i}", f"n{i}") for i in range(10)]
    return tn.Drivetrain("clamped", [*masses, *middle, tn.Lock("left", node="n0"), tn.Lock("right", node="n9")])


def full_mesh():
    """Every node joined with every other: more loops than lines could show."""
    nodes = [f"n{i}" for i in range(6)]
    pairs = itertools.combinations(nodes, 2)
    springs = [tn.Spring(f"k_{a}_{b}", nodes=(a, b), stiffness=1) for a, b in pairs]
    return tn.Drivetrain("mesh", [*(inertia(f"J_{node}", node) for node in nodes), *springs])


def axle(*, locked=False):
    """A rear axle: propeller shaft, final drive, differential, two half shafts."""
    return tn.Drivetrain(
        "rear axle",
        [
            inertia("flange", "p", 0.02),
            tn.Spring(
                "propeller_shaft", nodes=("p", "pinion"), stiffness="20 kN*m/rad", damping={"zeta": 0.01, "at": "90 Hz"}
            ),
            tn.Gear("final_drive", nodes=("pinion", "cage"), teeth=(11, 43)),
            tn.Differential("differential", cage="cage", left="l", right="r", locked=locked),
            tn.Spring("half_shaft_left", nodes=("l", "wl"), stiffness="9 kN*m/rad"),
            tn.Spring("half_shaft_right", nodes=("r", "wr"), stiffness="7 kN*m/rad"),
            inertia("wheel_left", "wl", 1.1),
            inertia("wheel_right", "wr", 1.1),
        ],
        inputs={"T_P": {"torque": "p"}},
        sensors={"T_L": {"torque": "half_shaft_left"}, "w_R": {"velocity": "wr"}},
    )


def planetary(held=None):
    """One set between motor and load, the ring clamped, held by a spring, or with an inertia of its own."""
    ring = {
        "clamped": [tn.Lock("brake", node="ring")],
        "held": [tn.Spring("ring_mount", nodes=("ring", "ground"), stiffness="1 MN*m/rad")],
        None: [inertia("ring_inertia", "ring", 0.4), tn.Spring("ring_shaft", nodes=("ring", "second"), stiffness=8e3),
               inertia("second_motor", "second", 0.1)],
    }[held]  # fmt: skip
    return tn.Drivetrain(
        f"planetary set, ring {held or 'free'}",
        [
            inertia("motor", "m", 0.03),
            tn.Spring("sun_shaft", nodes=("m", "sun"), stiffness="4 kN*m/rad"),
            tn.Planetary("set", sun="sun", ring="ring", carrier="carrier", teeth=(28, 92), planet_inertia=1e-4),
            tn.Spring("output_shaft", nodes=("carrier", "load"), stiffness="60 kN*m/rad"),
            inertia("load", "load", 2),
            *ring,
        ],
        inputs={"T_M": {"torque": "m"}},
    )


def planetary_of_gears():
    """Sun, planets and ring as meshes of their own, whose housing is the carrier."""
    return tn.Drivetrain(
        "planetary set built from gears",
        [
            inertia("motor", "sun", 0.02),
            tn.Gear("sun_mesh", nodes=("sun", "planet"), teeth=(28, -32), stiffness="0.4 MN*m/rad", housing="carrier"),
            tn.Gear("ring_mesh", nodes=("planet", "ring"), teeth=(32, 92), stiffness="0.6 MN*m/rad", housing="carrier"),
            inertia("planets", "planet", 0.004),
            inertia("ring_gear", "ring", 0.3),
            tn.Spring("ring_mount", nodes=("ring", "ground"), stiffness="2 MN*m/rad"),
            inertia("carrier_body", "carrier", 0.1),
            tn.Spring("output_shaft", nodes=("carrier", "load"), stiffness="60 kN*m/rad"),
            inertia("load", "load", 3),
        ],
        inputs={"T_M": {"torque": "sun"}},
    )


def moving_housing():
    """A compliant stage whose housing swings on its mounts."""
    return tn.Drivetrain(
        "gearbox on mounts",
        [
            inertia("motor", "a", 0.05),
            tn.Spring("input_shaft", nodes=("a", "b"), stiffness=4e3, damping=1),
            tn.Gear("stage", nodes=("b", "c"), teeth=(17, -61), stiffness="0.3 MN*m/rad", damping=20, housing="case"),
            tn.Spring("output_shaft", nodes=("c", "d"), stiffness=3e4),
            inertia("load", "d", 4),
            inertia("casing", "case", 6),
            tn.Spring("mounts", nodes=("case", "ground"), stiffness="50 kN*m/rad", damping=200),
        ],
        inputs={"T_M": {"torque": "a"}},
        sensors={"T_1": {"torque": "stage"}, "T_2": {"torque": "stage", "at": "second"}, "phi": {"angle": "case"}},
    )


def branches():
    """Two machines on one shaft, one at its end and one at a gear in the middle."""
    return tn.Drivetrain(
        "two branches",
        [
            inertia("engine", "e", 1.2),
            tn.Spring("coupling", nodes=("e", "hub"), stiffness=9e3, damping=30),
            inertia("hub_disc", "hub", 0.3),
            tn.Spring("pump_shaft", nodes=("hub", "pump"), stiffness=2e4),
            inertia("pump_rotor", "pump", 0.8),
            tn.Spring("fan_shaft", nodes=("hub", "fan"), stiffness=1e4),
            inertia("fan_wheel", "fan", 2),
            tn.Gear("power_take_off", nodes=("hub", "pto"), ratio="z_b/z_a"),
            tn.Spring("generator_shaft", nodes=("pto", "gen"), stiffness=800),
            inertia("generator", "gen", 0.05),
        ],
        parameters={"z_a": 63, "z_b": -21},
        inputs={"T_E": {"torque": "e"}},
    )


def torque_split():
    """Twin pinions on one bull gear: a closed loop."""
    return tn.Drivetrain(
        "torque split",
        [
            inertia("turbine", "t", 0.5),
            tn.Gear("upper", nodes=("t", "u"), teeth=(20, -50)),
            tn.Gear("lower", nodes=("t", "v"), teeth=(20, -50)),
            tn.Spring("quill_upper", nodes=("u", "u2"), stiffness=2e4),
            tn.Spring("quill_lower", nodes=("v", "v2"), stiffness=2e4),
            inertia("pinion_upper", "u2", 0.1),
            inertia("pinion_lower", "v2", 0.1),
            tn.Gear("bull_upper", nodes=("u2", "out"), teeth=(19, -110), stiffness=1e6),
            tn.Gear("bull_lower", nodes=("v2", "out"), teeth=(19, -110), stiffness=1e6),
            inertia("propeller", "out", 300),
        ],
        inputs={"T_T": {"torque": "t"}},
    )


def crankshaft():
    """Twelve cylinders with damper, flywheel and load."""
    cylinders = [f"cyl_{i}" for i in range(1, 13)]
    stations = ["damper_ring", "hub", *cylinders, "flywheel"]
    shafts = [
        tn.Spring(f"shaft_{i}", nodes=pair, stiffness="3.2 MN*m/rad")
        for i, pair in enumerate(itertools.pairwise(stations[1:]))
    ]
    return tn.Drivetrain(
        "twelve-cylinder engine",
        [
            inertia("ring", "damper_ring", 0.9),
            tn.Spring("viscous_damper", nodes=("damper_ring", "hub"), stiffness="90 kN*m/rad", damping=1500),
            inertia("hub_inertia", "hub", 0.3),
            *(inertia(f"crank_{i}", node, 0.6) for i, node in enumerate(cylinders, 1)),
            *(tn.Damper(f"friction_{i}", nodes=(node, "ground"), damping=8) for i, node in enumerate(cylinders, 1)),
            *shafts,
            inertia("flywheel_disc", "flywheel", 9),
            tn.Spring("coupling", nodes=("flywheel", "alternator"), stiffness="0.3 MN*m/rad", damping=500),
            inertia("rotor", "alternator", 40),
        ],
        inputs={f"T_{i}": {"torque": node} for i, node in enumerate(cylinders, 1)},
        sensors={"speed": {"velocity": "flywheel"}, "T_C": {"torque": "coupling"}},
    )


def crowded():
    """Everything at one node."""
    return tn.Drivetrain(
        "all at one node",
        [
            inertia("rotor", "a", 0.4),
            inertia("fan", "a", 0.1),
            inertia("brake_disc", "a", 0.2),
            tn.Damper("seal", nodes=("a", "ground"), damping=0.2),
            tn.Damper("bearing", nodes=("a", "ground"), damping=0.1),
            tn.Damper("windage", nodes=("a", "ground"), damping=0.3),
            tn.Spring("return_spring", nodes=("a", "ground"), stiffness=20, damping=1),
            tn.Spring("shaft", nodes=("a", "b"), stiffness=500),
            inertia("load", "b", 0.9),
        ],
        inputs={"T_1": {"torque": "a"}, "T_2": {"torque": "a"}, "T_3": {"torque": "a"}, "T_b": {"torque": "b"}},
        sensors={
            "theta_a": {"angle": "a"},
            "omega_a": {"velocity": "a"},
            "alpha_a": {"acceleration": "a"},
            "T_s": {"torque": "shaft"},
            "T_e": {"torque": "shaft", "at": "b"},
            "T_seal": {"torque": "seal"},
            "phi": {"twist": "shaft"},
            "theta_b": {"angle": "b"},
        },
    )


def long_names():
    return tn.Drivetrain(
        "names of the length that model exporters make",
        [
            inertia("high_pressure_compressor_rotor_first_spool", "compressor_outlet_flange_station_4", 0.2),
            tn.Spring(
                "intermediate_shaft_between_compressor_and_gearbox_input",
                nodes=("compressor_outlet_flange_station_4", "gearbox_input_spline_drive_side"),
                stiffness="k_theta_long_index_of_a_parameter",
                damping="c_lambda",
            ),
            inertia("J_omega", "gearbox_input_spline_drive_side", "Omega_total_inertia_of_the_input"),
            tn.Gear(
                "reduction_gear_first_stage_left_hand", nodes=("gearbox_input_spline_drive_side", "x_2"), ratio=-2.5
            ),
            tn.Shaft("x", nodes=("x_2", "theta_psi"), outer_diameter=0.04, length=0.7),
            inertia("Theta_load", "theta_psi", 3),
        ],
        parameters={
            "k_theta_long_index_of_a_parameter": "4 kN*m/rad",
            "c_lambda": 3,
            "Omega_total_inertia_of_the_input": 0.3,
        },
        inputs={"torque_of_the_starter_motor_at_cranking": {"torque": "compressor_outlet_flange_station_4"}},
        sensors={"omega_of_the_second_encoder_channel_b": {"velocity": "theta_psi"}, "T_x": {"torque": "x"}},
    )


def imposed():
    """An imposed angle, a torque meter between couplings, reactions of clamps."""
    return tn.Drivetrain(
        "imposed angle",
        [
            tn.Spring("input_shaft", nodes=("a", "b"), stiffness=900, damping=1),
            inertia("disc", "b", 0.4),
            tn.RigidCoupling("torque_meter", nodes=("b", "c")),
            tn.Shaft("test_piece", nodes=("c", "d"), outer_diameter="30 mm", inner_diameter="12 mm", length="0.4 m"),
            tn.RigidCoupling("flange", nodes=("d", "e")),
            tn.Lock("clamp", node="e"),
        ],
        inputs={"theta_E": {"angle": "a"}},
        sensors={"T_T": {"torque": "torque_meter"}, "T_R": {"torque": "clamp"}},
    )


def gear_to_ground():
    """A stage whose second wheel stands still: an epicyclic arm."""
    return tn.Drivetrain(
        "wheel on the ground",
        [
            inertia("motor", "a", 0.1),
            tn.Gear("stage", nodes=("a", "ground"), ratio=-3, stiffness=2e3, housing="arm"),
            tn.Spring("shaft", nodes=("arm", "b"), stiffness=300),
            inertia("load", "b", 1),
        ],
    )


def two_sets():
    """A two-speed box: two planetary sets with a common carrier shaft, one sun clamped."""
    return tn.Drivetrain(
        "two planetary sets",
        [
            inertia("turbine", "in", 0.1),
            tn.Planetary("front", sun="s", ring="in", carrier="mid", teeth=(38, 76)),
            tn.Planetary("rear", sun="s", ring="mid2", carrier="out", ratio=2.4, stiffness=1e6),
            tn.Spring("link", nodes=("mid", "mid2"), stiffness=5e4),
            tn.Lock("band", node="s"),
            tn.Spring("output_shaft", nodes=("out", "w"), stiffness=9e3),
            inertia("wheel", "w", 3),
        ],
    )


def random_one(seed):
    return draw(random.Random(seed), loops=seed % 3, planetary=seed % 2 == 1, count=3 + seed % 6)[0]


MODELS = {
    "hybrid": hybrid,
    "parallel": parallel,
    "star": star,
    "clamped": ends_clamped,
    "mesh": full_mesh,
    "chain of 41": lambda: chain(41),
    "axle": axle,
    "locked axle": lambda: axle(locked=True),
    "planetary, ring clamped": lambda: planetary("clamped"),
    "planetary, ring held": lambda: planetary("held"),
    "planetary, all free": planetary,
    "planetary of gears": planetary_of_gears,
    "moving housing": moving_housing,
    "branches": branches,
    "torque split": torque_split,
    "crankshaft": crankshaft,
    "crowded": crowded,
    "long names": long_names,
    "imposed": imposed,
    "wheel on the ground": gear_to_ground,
    "two sets": two_sets,
    **{f"random {seed}": lambda seed=seed: random_one(seed) for seed in range(8)},
}
