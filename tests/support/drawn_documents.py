"""Plants for a calculation for approval, drawn at random: masses and shafts in line, a gear, a branch, limits."""

import math

import numpy as np

import torsionnet as tn
from torsionnet.report import make_report
from torsionnet.report.writers.markdown import MarkdownWriter


def drawn_plant(seed):
    """An engine of equal throws, a coupling, perhaps a gear and a branch, a propeller or a machine with limits."""
    draw = np.random.default_rng(seed)
    throws = int(draw.integers(2, 4))
    J, k = draw.uniform(5, 60), draw.uniform(3e6, 4e7)
    ratio = float(np.round(draw.uniform(1.5, 5), 2)) if draw.random() < 0.6 else 1.0
    rated = float(np.round(draw.uniform(600, 1500)))
    power = draw.uniform(0.3, 1.0) * 40 * J * rated  # W
    torque = power / (rated * math.pi / 30)
    nodes = [f"c{number + 1}" for number in range(throws)]
    elements = [tn.Inertia(f"m_{node}", node=node, inertia=J) for node in nodes]
    elements += [
        tn.Spring(f"crank_{number}", nodes=pair, stiffness=k, damping={"zeta": 0.01, "at": "60 Hz"})
        for number, pair in enumerate(zip(nodes, [*nodes[1:], "fly"], strict=True), 1)
    ]
    elements.append(tn.Inertia("flywheel", node="fly", inertia=draw.uniform(2, 12) * J))
    if draw.random() < 0.5:
        ring = draw.uniform(0.5, 1.5) * J
        elements.append(
            tn.ViscousDamper(
                "damper", node="c1", ring_inertia=ring, damping=ring * draw.uniform(100, 600), hub_inertia=0.2 * J
            )
        )
    coupling = {"stiffness": draw.uniform(5, 40) * torque, "loss_factor": {"psi": draw.uniform(0.4, 1.3)}}
    elements += [tn.HystereticSpring("coupling", nodes=("fly", "hub"), **coupling),
                 tn.Inertia("hub_mass", node="hub", inertia=draw.uniform(0.5, 3) * J)]  # fmt: skip
    last = "hub"
    if ratio > 1:
        last = "wheel"
        elements += [
            tn.Gear("mesh", nodes=("hub", "wheel"), ratio=-ratio),
            tn.Inertia("wheel_mass", node="wheel", inertia=draw.uniform(2, 20) * J),
        ]
    diameter = 1.2 * (16 * torque * ratio / (math.pi * 30e6)) ** (1 / 3)
    line = {
        "outer_diameter": float(np.round(diameter, 3)),
        "length": draw.uniform(1, 8),
        "segments": int(draw.integers(1, 4)),
    }
    if draw.random() < 0.5:
        line["inner_diameter"] = 0.3 * line["outer_diameter"]
    elements += [
        tn.Shaft("line", nodes=(last, "p"), damping={"zeta": 0.005, "at": "20 Hz"}, **line),
        tn.Inertia("screw", node="p", inertia=draw.uniform(10, 60) * J * ratio),
        tn.Damper(
            "water", nodes=("p", "ground"), damping=draw.uniform(0.5, 2.5) * torque * ratio**2 / (rated * math.pi / 30)
        ),
    ]
    if draw.random() < 0.5:
        elements += [
            tn.Spring(
                "pto",
                nodes=("hub", "gen"),
                stiffness=draw.uniform(10, 80) * torque,
                damping={"zeta": 0.02, "at": "20 Hz"},
            ),
            tn.Inertia("generator", node="gen", inertia=draw.uniform(0.3, 3) * J),
        ]
    orders = {order: {"amplitude": draw.uniform(0.02, 0.5) * torque / throws} for order in (1, 1.5, throws)}
    gas = {
        f"gas_{node}": {"type": "harmonic", "node": node, "orders": {
            order: {**one, "phase": f"{360 * order * number / throws:.4f} deg"} for order, one in orders.items()
        }}
        for number, node in enumerate(nodes)
    }  # fmt: skip
    blades = {"type": "propeller", "node": "p", "blades": 4, "torque": torque * ratio, "rated": f"{rated / ratio} rpm",
              "blade_orders": {1: {"share": "8 %"}, 2: {"share": "2 %"}}}  # fmt: skip
    limits = {
        "line": {"rule": "iacs_m68", "element": "line", "shaft": "intermediate", "feature": "integral_flange",
                 "material": "carbon", "tensile_strength": "560 MPa"},
        "rubber": {"rule": "coupling", "element": "coupling", "T_KN": 1.3 * torque, "T_Kmax": 3 * torque,
                   "T_KW": draw.uniform(0.1, 0.5) * torque, "P_KV": draw.uniform(0.1, 1) * 1e-3 * power, "source": "sheet"},
        "crankshaft": {"rule": "curve", "output": f"torque(crank_{throws})", "value": draw.uniform(0.5, 3) * torque,
                       "source": "maker"},
    }  # fmt: skip
    if ratio > 1:
        limits["teeth"] = {"rule": "gear", "element": "mesh", "vibratory_share": "30 %"}
    factor = draw.uniform(1.1, 3)
    louder = {order: {"amplitude": factor * one["amplitude"]} for order, one in orders.items()}
    return tn.Drivetrain(
        f"drawn plant {seed}", elements,
        sensors={"T_line": {"torque": "line"}, "phi": {"angle": "c1"}},
        speeds={"of": "fly", "range": f"{0.4 * rated}..{1.05 * rated} rpm", "step": f"{rated / 40} rpm", "rated": f"{rated} rpm"},
        load={"absorbed_at": "p", "power": power, "torque_exponent": 2, "driven_by": {"c1": 1}},
        excitations={**gas, "blades": blades}, limits=limits,
        configurations={"firing": {"normal": {}, "uneven": {"gas_c1.orders": louder}}},
    )  # fmt: skip


def printed(plant):
    """The document of a plant as its text."""
    return MarkdownWriter(make_report(plant, date=None), "figures").page()
