"""The front-wheel-drive car with a clutch, gearboxes, a final drive, tyres and a vehicle as elements."""

HEAD = """torsionnet: 1
name: Front-wheel-drive car by its components
parameters:
  J_eng: {value: 0.115 kg*m^2}
  J_prim: {value: 0.105 kg*m^2}
  J_sec: {value: 0.062 kg*m^2}
  k_crk: 48 kN*m/rad
  k_deg: 800 N*m/rad
  k_in: 9.5 kN*m/rad
  m_veh: 1550 kg
  r_t: 0.312 m
  k_ty: 21 kN*m/rad
  c_ty: 180 N*m*s/rad
  f1: 3.45
  f2: 2.76
"""
SAME = """
  crank: {type: inertia, node: pulley, inertia: J_eng}
  crank_tw: {type: spring, nodes: [pulley, prim], stiffness: k_crk, damping: {zeta: 0.02, at: 300 Hz}}
  primary: {type: inertia, node: prim, inertia: J_prim}
  dmf: {type: hysteretic_spring, nodes: [prim, sec], stiffness: k_deg, loss_factor: 0.25}
  secondary: {type: inertia, node: sec, inertia: J_sec}
  block: {type: inertia, node: block, inertia: 9.5 kg*m^2}
  mount: {type: spring, nodes: [block, ground], stiffness: 32 kN*m/rad, damping: {zeta: 0.06, at: 9 Hz}}
  half_l: {type: spring, nodes: [dl, hub_l], stiffness: 9.2 kN*m/rad, damping: {zeta: 0.01, at: 10 Hz}}
  half_r: {type: spring, nodes: [dr, hub_r], stiffness: 6.1 kN*m/rad, damping: {zeta: 0.01, at: 10 Hz}}
  wheel_l: {type: inertia, node: hub_l, inertia: 0.9 kg*m^2}
  wheel_r: {type: inertia, node: hub_r, inertia: 0.9 kg*m^2}
inputs: {T_E: {torque: pulley}, T_block: {torque: block}}
sensors:
  n_prim: {velocity: prim}
  a_sec: {acceleration: sec}
  T_hl: {torque: half_l}
  T_hr: {torque: half_r}
  a_veh: {acceleration: road}
  roll: {angle: block}
"""
COMPONENTS = """elements:
  clutch: {type: clutch, nodes: [sec, inp], disc_inertia: 0.0045 kg*m^2, stiffness: k_in,
           damping: {zeta: 0.01, at: 100 Hz}}
  box: {type: gearbox, input: inp, output: out1, ratios: {I: -3.769, II: -1.958, III: -1.257, IV: -0.870},
        engaged: III, housing: block, input_inertia: 0.0021 kg*m^2, output_inertia: 0.0032 kg*m^2,
        wheel_inertias: {I: 0.0041 kg*m^2, II: 0.0026 kg*m^2, III: 0.0016 kg*m^2, IV: 0.0011 kg*m^2}}
  high: {type: gearbox, input: inp, output: out2, engaged: neutral, ratios: {V: -0.857, VI: -0.717}, housing: block,
         output_inertia: 0.0028 kg*m^2, wheel_inertias: {V: 0.0010 kg*m^2, VI: 0.0009 kg*m^2}}
  axle: {type: final_drive, pinion: out1, cage: cage, left: dl, right: dr, ratio: -f1, housing: block,
         cage_inertia: 0.028 kg*m^2}
  second: {type: gear, nodes: [out2, cage], ratio: -f2, housing: block}
  tyre_l: {type: tyre, nodes: [hub_l, road], state: standing, stiffness: k_ty, damping: c_ty}
  tyre_r: {type: tyre, nodes: [hub_r, road], state: standing, stiffness: k_ty, damping: c_ty}
  vehicle: {type: vehicle, node: road, mass: m_veh, wheel_radius: r_t}"""
GEARS = """configurations:
  gear:
    I: {box.engaged: I}
    II: {box.engaged: II}
    III: {}
    IV: {box.engaged: IV}
    V: {box.engaged: neutral, high.engaged: V}
    VI: {box.engaged: neutral, high.engaged: VI}
    N: {box.engaged: neutral}
  clutch: {closed: {}, open: {clutch.state: open}}
"""
RATIOS = {"I": 3.769, "II": 1.958, "III": 1.257, "IV": 0.870, "V": 0.857, "VI": 0.717}
INERTIAS = {"I": 0.0041, "II": 0.0026, "III": 0.0016, "IV": 0.0011, "V": 0.0010, "VI": 0.0009}


def components():
    """The model file with elements of its field."""
    return HEAD + COMPONENTS + SAME + GEARS


def springs_and_gears():
    """The same car of inertias, springs, gears and rigid couplings."""
    lines = [HEAD + "elements:"]
    lines.append("  clutch: {type: rigid_coupling, nodes: [sec, disc]}")
    lines.append("  disc: {type: inertia, node: disc, inertia: 0.0045}")
    lines.append("  disc_sp: {type: spring, nodes: [disc, inp], stiffness: k_in, damping: {zeta: 0.01, at: 100 Hz}}")
    lines.append("  input_sh: {type: inertia, node: inp, inertia: 0.0021}")
    for gear, ratio in RATIOS.items():
        out, off = ("out1" if gear in ("I", "II", "III", "IV") else "out2"), ", enabled: false" * (gear != "III")
        lines.append(f"  g{gear}: {{type: gear, nodes: [inp, w{gear}], ratio: -{ratio}, housing: block}}")
        lines.append(f"  J{gear}: {{type: inertia, node: w{gear}, inertia: {INERTIAS[gear]}}}")
        lines.append(f"  s{gear}: {{type: rigid_coupling, nodes: [w{gear}, {out}]{off}}}")
    lines.append("  out1: {type: inertia, node: out1, inertia: 0.0032}")
    lines.append("  out2: {type: inertia, node: out2, inertia: 0.0028}")
    lines.append("  fd1: {type: gear, nodes: [out1, cage], ratio: -f1, housing: block}")
    lines.append("  fd2: {type: gear, nodes: [out2, cage], ratio: -f2, housing: block}")
    lines.append("  crown: {type: inertia, node: cage, inertia: 0.028}")
    lines.append("  diff: {type: differential, cage: cage, left: dl, right: dr}")
    lines.append("  tyre_l: {type: spring, nodes: [hub_l, road], stiffness: k_ty, damping: c_ty}")
    lines.append("  tyre_r: {type: spring, nodes: [hub_r, road], stiffness: k_ty, damping: c_ty}")
    lines.append("  vehicle: {type: inertia, node: road, inertia: m_veh*r_t**2}")
    switches = [f"    {gear}: {{on: [s{gear}], off: [sIII]}}" for gear in RATIOS if gear != "III"]
    gears = ["configurations:", "  gear:", *switches, "    III: {on: [sIII]}", "    N: {off: [sIII]}"]
    clutch = ["  clutch: {closed: {on: [clutch]}, open: {off: [clutch]}}", ""]
    return "\n".join(lines) + SAME + "\n".join([*gears, *clutch])
