"""Plants that run: excitations of every type, limits of every rule, a load, values that follow it, and their files."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from fuzz.mutating import Chance

PLANT = """\
torsionnet: 1
name: small ship
elements:
  throw_1: {type: inertia, node: c1, inertia: 4 kg*m^2}
  crank: {type: spring, nodes: [c1, c2], stiffness: 4 MN*m/rad, damping: 60 N*m*s/rad}
  throw_2: {type: inertia, node: c2, inertia: 4 kg*m^2}
  tvd: {type: viscous_damper, node: c1, ring_inertia: 1.5 kg*m^2, damping: 300 N*m*s/rad}
  rubber: {type: hysteretic_spring, nodes: [c2, pin], stiffness: k_cpl, loss_factor: {psi: 1.13}}
  pinion: {type: inertia, node: pin, inertia: 1 kg*m^2}
  mesh: {type: gear, nodes: [pin, wheel], teeth: [17, -61], stiffness: 90 MN*m/rad}
  disc: {type: inertia, node: wheel, inertia: 30 kg*m^2}
  shaft: {type: shaft, nodes: [wheel, prop], outer_diameter: 120 mm, length: 4 m, segments: 2}
  screw: {type: propeller, node: prop, inertia: 40 kg*m^2, entrained_water: 0.25, archer: 30, torque: Q, speed: n}
parameters:
"""
FOLLOWING = """\
  Q: {by: load, of: prop}
  n: {by: speed, of: prop}
  k_cpl: {by: mean_torque, of: rubber, table: {0 kN*m: 0.02 MN*m/rad, 2 kN*m: 0.025 MN*m/rad, 5 kN*m: 0.04 MN*m/rad}}
"""
SOFTENING = """\
  Q: {by: load, of: prop}
  n: {by: speed, of: prop, table: {1 rpm: 1 rpm, 900 rpm: 900 rpm}}
  k_cpl: {by: vibratory_torque, of: rubber, table: {0 N*m: 25 kN*m/rad, 1 kN*m: 20 kN*m/rad, 100 kN*m: 18 kN*m/rad}}
"""
FIXED = "  Q: 3 kN*m\n  n: 200 rpm\n  k_cpl: 25 kN*m/rad\n"
SPEEDS = (
    "speeds: {of: c1, range: 300..900 rpm, step: 100 rpm, rated: 800 rpm}\n",
    "speeds: {of: c1, range: 300..900 rpm, step: 100 rpm, rated: 800 rpm}\n",
    "speeds: {of: prop, list: [100 rpm, 150 rpm, 230 rpm], rated: 220 rpm}\n",
)
LOADS = (
    "load: {absorbed_at: prop, power: 200 kW, torque_exponent: 2, driven_by: {c1: 0.5, c2: 0.5}}\n",
    "load: {absorbers: {prop: {torque: 3 kN*m, torque_exponent: 2, rated: 230 rpm}, wheel: {power: 5 kW, torque_exponent: 0}}, driven_by: {c2: 1}}\n",
    "load:\n  absorbed_at: prop\n  over_speed: {10 rpm: 0 kN*m, 150 rpm: 2 kN*m, 300 rpm: 5 kN*m}\n  driven_by: {c2: 100 %}\n",
)
ENGINE = """\
    type: reciprocating_engine
    speed_of: c1
    cycle: 4
    cylinders: {1: c1, 2: c2, 3: c1, 4: c2}
    firing_order: [1, 2, 3, 4]
    bore: 160 mm
    stroke: 190 mm
    rod_length: 340 mm
    reciprocating_mass: 9.5 kg
"""
BAR = "60e5, 42e5, 20e5, 9e5, 5e5, 3e5, 2e5, 2e5, 2e5, 2e5, 2e5, 2e5, 2e5, 2e5, 2e5, 2e5, 2e5, 2e5, 3e5, 5e5, 9e5, 20e5, 33e5, 49e5"
"""Two dozen pressures over a cycle."""
ENGINES = (
    ENGINE + "    gas: {traces: {0 bar: compression.csv, 27 bar: p100.csv}, motored: compression.csv, zero: firing_tdc}\n"
    "    load: {power: 180 kW, mechanical_efficiency: 0.92, rated: 800 rpm, exponent: 2}\n",
    ENGINE + "    gas: {fired: p100.csv, motored: compression.csv, rated: 800 rpm, exponent: 2}\n    orders: [0.5, 1, 1.5, 2]\n",
    ENGINE + f"    gas:\n      fired: [{BAR}]\n"
    "      crankcase: 1 bar\n      reference: gauge\n    factors: {2: 0.8}\n    spread: 5 %\n    piston_rod: 60 mm\n",
    ENGINE + "    gas:\n      harmonics:\n        5 bar: {0.5: {amplitude: 1.3 bar, phase: -79 deg}, 2: {amplitude: 1.2 bar, phase: 0 deg}}\n"
    "        20 bar: {0.5: {amplitude: 5.1 bar, phase: -77 deg}, 2: {amplitude: 4.6 bar, phase: 0 deg}}\n"
    "      motored_harmonics: {0.5: {cosine: 0 bar, sine: 1.3 bar}, 1: {cosine: 0 bar, sine: 1.1 bar}}\n"
    "    load: {mean_indicated_pressure: 18 bar}\n",
    ENGINE.replace("cycle: 4", "cycle: 2").replace("firing_order: [1, 2, 3, 4]", "firing_angles: {1: 0 deg, 2: 180 deg, 3: 90 deg, 4: 270 deg}")
    + "    gas: {fired: head_end.csv, crank_end: head_end.csv, crankcase: 1 bar}\n",
    ENGINE.replace("firing_order", "banks: {A: [1, 2], B: [3, 4]}\n    bank_angle: 90 deg\n    firing_order") + "    misfire: each\n"
    "    gas: {fired: p100.csv, motored: {start: 0.5 deg, pressures: [" + BAR + "]}}\n",
)  # fmt: skip
EXCITATIONS = (
    "{type: propeller, node: prop, blades: 4, torque: 3 kN*m, rated: 230 rpm, blade_orders: {1: {share: 8 %, phase: 3 deg}, 2: {share: 2 %}}}",
    "{type: propeller, node: prop, blades: 3, torque: 3 kN*m, rated: 230 rpm, pitch: controllable, phase_zero: blade, blade_angle: 10 deg,"
    " blade_orders: {1: {share: 8 %}}, conditions: {zero: {torque: 10 %, blade_orders: {1: {share: 20 %}}}}, condition: zero}",
    "{type: electric_machine, node: wheel, pole_pairs: 2, rated_torque: 1 kN*m, orders: {2: {amplitude: 60 N*m}}, electrical_orders: {6: {share: 2 %}},"
    " line: {frequency: 50 Hz, multiples: {6: {share: 2 %}}}, frequencies: {17 Hz: {amplitude: 3 N*m}}}",
    "{type: electric_machine, node: wheel, pole_pairs: 3, slip: {frequency: 50 Hz, amplitude: [[0 rpm, 60 N*m], [1500 rpm, 40 N*m]]},"
    " short_circuit: {frequency: 50 Hz, phases: 2, once: 90 N*m, twice: 45 N*m}}",
    "{type: gear_mesh, mesh: mesh, base_radius: 40 mm, transmission_error: {1: {way: 4 um}, 2: {way: 1 um, phase: 20 deg}}, run_out: {angle: 60 urad}}",
    "{type: universal_joint, joint: rubber, angle: 9 deg, phase: 10 deg, multiples: 2}",
    "{type: harmonic, node: c2, reaction: wheel, orders: {2: {amplitude: 100 N*m, phase: 30 deg}}, factor: [[0 rpm, 1], [900 rpm, 2]]}",
    "{type: harmonic, node: c2, speed_of: prop, frequencies: {50 Hz: {velocity: 2 rad/s}}}",
    "{type: measured, node: wheel, table: orders.csv}",
    "{type: measured, node: wheel, speed_of: c1, table: {columns: ['frequency [Hz]', 'rms [N*m]'], rows: [[17, 30], [40, 3]]}}",
    "{type: measured, node: c2, table: {columns: [order, 'speed [rpm]', 'real [deg]', 'imag [deg]'], rows: [[2, 300, 1, 0], [2, 900, 2, 1]]}}",
)
LIMITS = (
    "{rule: iacs_m68, element: shaft, shaft: intermediate, feature: integral_flange, material: carbon, tensile_strength: 560 MPa, safe_speed: 500 rpm}",
    "{rule: iacs_m68, element: shaft, shaft: propeller, feature: keyless, material: alloy, tensile_strength: 600 MPa, tachometer_tolerance: 1 %}",
    "{rule: iacs_m68, element: shaft, shaft: intermediate, feature: longitudinal_slot, material: carbon, tensile_strength: 560 MPa, slot_length: 60 mm, slot_width: 20 mm}",
    "{rule: coupling, element: rubber, T_KN: 5 kN*m, T_Kmax: 8 kN*m, T_KW: 1.5 kN*m, P_KV: 0.2 kW, twist: 9 deg, frequency_factor: din_740_2}",
    "{rule: gear, element: mesh, vibratory_share: 30 %, hammer: true}",
    "{rule: damper, element: tvd, power_per_area: 9 kW/m^2, area: 0.4 m^2, vibratory_twist: 2 deg}",
    "{rule: machine_angle, node: wheel, pole_pairs: 4, angle: 3.5 deg}",
    "{rule: fatigue, element: shaft, fatigue_strength: 150 MPa, ultimate_strength: 500 MPa, cycles: 1e5, slope: 5, yield_strength: 300 MPa}",
    "{rule: curve, output: torque(crank), over_lambda: {0.1: 40 kN*m, 1.2: 30 kN*m}, transient_factor: 1.5, source: maker}",
    "{rule: curve, output: stress(shaft), over_speed: {100 rpm: 40 MPa, 1000 rpm: 30 MPa}, measure: each_order, orders: [2, 4], source: own}",
)
OVERRIDES = (
    "{load.power: 100 kW}", "{load.driven_by: {c2: 1}}", "{k_cpl: 30 kN*m/rad}", "{off: [tvd]}", "{off: [crank]}", "{on: [tvd], Q: 1 kN*m}",
    "{m0.T_KW: 3 kN*m}", "{speeds.rated: 500 rpm}",
)  # fmt: skip
OF_ENGINE = (
    "{engine.misfire: [2]}", "{engine.misfire: each, engine.gas_off: [1]}", "{engine.factors: {2: 0.5}, engine.spread: 3 %}", "{engine.enabled: false}",
    "{engine.gas: {fired: compression.csv}}", "{engine.cylinders: {1: c1, 2: c2}, engine.firing_order: [2, 1]}", "{engine.load: {mean_indicated_pressure: 9 bar}}",
)  # fmt: skip
OF_OTHERS = (
    "{x0.enabled: false}",
    "{x0.orders: {3: {amplitude: 4 N*m}}}",
    "{x0.condition: zero}",
    "{x0.speed_of: prop}",
    "{x0.angle: 5 deg}",
)


def plant(chance: Chance) -> str:
    """A model file with some of everything that runs, sound or contradicting itself."""
    acting = chance.sample(EXCITATIONS, chance.randint(0, 3))
    borne = chance.sample(LIMITS, chance.randint(0, 3))
    has_engine = chance.random() < 0.7 or not acting
    parts = [
        PLANT,
        chance.choice([FOLLOWING, SOFTENING, FIXED, FIXED]),
        "inputs: {T: {torque: c1}}\nsensors: {phi: {angle: c1}, T_C: {torque: rubber}, tau: {stress: shaft}}\n",
        chance.choice(SPEEDS),
        chance.choice([*LOADS, LOADS[0], ""]),
        f"excitations:\n  engine:\n{chance.choice(ENGINES)}" if has_engine else "excitations:\n",
        "".join(f"  x{number}: {text}\n" for number, text in enumerate(acting)),
        "limits:\n" + "".join(f"  m{number}: {text}\n" for number, text in enumerate(borne)) if borne else "",
    ]
    if chance.random() < 0.6:
        possible = [*OVERRIDES[:-2], *OF_ENGINE * has_engine, *OF_OTHERS * bool(acting), chance.choice(OVERRIDES)]
        alternatives = ", ".join(f"a{number}: {text}" for number, text in enumerate(chance.sample(possible, 2)))
        parts.append(f"configurations: {{normal: {{}}, {alternatives}}}\n")
    return "".join(parts)


SOUND = (
    PLANT + FIXED + "sensors: {T_C: {torque: rubber}}\n" + SPEEDS[0] + LOADS[0] + "excitations:\n  engine:\n" + ENGINES[0]
    + f"  screw: {EXCITATIONS[0]}\n" + "limits:\n" + "".join(f"  m{number}: {LIMITS[number]}\n" for number in (0, 3, 4, 5, 7))
)  # fmt: skip
"""Loads all modules."""
TRACED = SOUND.replace("27 bar: p100.csv", "27 bar: input.csv")
RECORDED = SOUND.replace(EXCITATIONS[0], "{type: measured, node: wheel, table: input.csv}")


def pressure(peak: float, cycle: int = 720, step: int = 10) -> str:
    """A trace over the crank angle in deg and bar."""
    angle = np.arange(0, cycle + step, step)
    values = 2 + peak * np.exp(30 * (np.cos(np.radians(angle) * 360 / cycle) - 1))
    return "angle [deg];pressure [bar]\n" + "".join(f"{at};{p:.3f}\n" for at, p in zip(angle, values, strict=True))


def traces() -> tuple[str, ...]:
    """Pressures as they are delivered."""
    rows = pressure(100)
    lines = rows.splitlines()[1:]
    comma = "Kurbelwinkel [°KW]\tp / MPa\n" + "".join(
        line.replace(".", ",").replace(";", "\t") + "\n" for line in lines
    )
    return rows, "\n".join(["# recorder 7", *rows.splitlines()[:-1]]), comma.replace(",", "."), comma


ORDERS = (
    "# recorder 7\norder;rms [N*m];phase [deg]\n2;30;90\n4;3;0\n",
    "order,speed [rpm],amplitude [N*m]\n2,100,30\n2,900,40\n4,100,3\n4,900,2\n",
    "frequency [Hz];real [deg/s];imag [deg/s]\n17;3;-4\n20;1;1\n",
)


def furnish(folder: Path) -> None:
    """What the plants refer to."""
    (folder / "p100.csv").write_text(pressure(100))
    (folder / "compression.csv").write_text(pressure(40))
    (folder / "head_end.csv").write_text(pressure(6, 360))
    (folder / "orders.csv").write_text(ORDERS[0])
