"""Two engines on one propeller through gears."""

import torsionnet as tn

TWINS = """torsionnet: 1
name: twins
elements:
  Ja: {type: inertia, node: a, inertia: 40}
  Jb: {type: inertia, node: b, inertia: 40}
  ka: {type: spring, nodes: [a, pa], stiffness: 40 kN*m/rad, damping: 90}
  kb: {type: spring, nodes: [b, pb], stiffness: 40 kN*m/rad, damping: 90}
  ga: {type: gear, nodes: [pa, w], ratio: -3}
  gb: {type: gear, nodes: [pb, w], ratio: RATIO}
  Jw: {type: inertia, node: w, inertia: 200}
  sh: {type: spring, nodes: [w, p], stiffness: 1 MN*m/rad, damping: 900}
  Jp: {type: inertia, node: p, inertia: 600}
  water: {type: damper, nodes: [p, ground], damping: 4 kN*m*s/rad}
speeds: {of: a, list: [410 rpm, 505 rpm, 730 rpm], rated: 750 rpm}
excitations:
  port: {PORT, ENGINE}
  star: {STAR, ENGINE}
  MORE
limits: {shaft: {rule: curve, output: torque(sh), value: 1 kN*m, source: own}}
configurations:
  engines: {both: {}, port: {star.enabled: false}}
"""
ENGINE = """type: reciprocating_engine, cycle: 4, firing_order: [1, 2, 3], bore: 200 mm, stroke: 250 mm, rod_length: 500 mm,
    gas: {harmonics: {0.5: {amplitude: 5 bar, phase: -77 deg}, 1: {amplitude: 4 bar, phase: -66 deg}, 1.5: {amplitude: 3
    bar, phase: -58 deg}, 3: {amplitude: 2 bar, phase: -41 deg}, 4.5: {amplitude: 1 bar, phase: 9 deg}}, motored_harmonics: {0.5: {cosine: 0 bar, sine:
    1 bar}, 1: {cosine: 0 bar, sine: 2 bar}}}, orders: [0.5, 1, 1.5, 2, 3, 4.5]"""
PORT = "speed_of: a, cylinders: {1: a, 2: a, 3: a}"
STAR = "speed_of: b, cylinders: {1: b, 2: b, 3: b}"
SCREW = "screw: {type: propeller, node: p, blades: 4, torque: 6 kN*m, rated: 240 rpm, blade_orders: {1: {share: 9 %}}}"


def text(port="", star="", ratio=-3, more=SCREW, engine=ENGINE):
    """Both engines with more entries."""
    engines = TWINS.replace("PORT", f"{PORT}{port}").replace("STAR", f"{STAR}{star}").replace("ENGINE", engine)
    return engines.replace("RATIO", str(ratio)).replace("MORE", more)


def plant(*args, **more):
    return tn.loads(text(*args, **more))
