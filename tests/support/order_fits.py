"""A small engine in dense matrices, written here, and orders measured at it with noise of a known size."""

from __future__ import annotations

import numpy as np

import torsionnet as tn
from torsionnet.signals.orders.tracked_orders import TrackedOrders

J_CYLINDER, J_FLYWHEEL, J_LOAD = 0.04, 1.2, 0.6
K_THROW, K_FLYWHEEL, K_COUPLING, C_THROW, C_COUPLING = 9e5, 1.3e6, 6e3, 40.0, 8.0
FIRING = (1, 5, 3, 6, 2, 4)
BORE, STROKE = 0.1, 0.12
HARMONICS = {
    0.5: (5.2e5, -0.4), 1.0: (5.6e5, 0.3), 1.5: (5.4e5, -1.2), 2.0: (4.6e5, 0.6), 2.5: (3.9e5, -0.9), 3.0: (3.3e5, 0.2),
    4.5: (1.6e5, -0.5), 6.0: (7.8e4, 0.8),
}  # fmt: skip
"""Amplitude (Pa) and phase (rad) of the tangential pressure by order, of the size of a diesel engine at full load."""
MOTORED = 0.35
"""Tangential pressure without injection over that with it: real, and the same at all orders, which suffices here."""
SPEEDS = np.linspace(900, 2000, 12) * np.pi / 30
TWISTS = {"T_cpl": (7, 8), "T_crank": (4, 5)}
"""Nodes (numbers in the chain) between which the torque of each output acts."""


def engine_model(**parameters):
    """Model of the same engine as a user writes it."""
    nodes = [f"c{number}" for number in range(1, 7)]
    elements = [tn.Inertia(f"J{node}", node=node, inertia="J_c") for node in nodes]
    elements += [
        tn.Spring(f"s{number}", nodes=(nodes[number - 1], nodes[number]), stiffness="k_throw", damping="c_throw")
        for number in range(1, 6)
    ]
    elements += [
        tn.Inertia("nose_disc", node="nose", inertia="J_nose"),
        tn.Spring("front", nodes=("nose", "c1"), stiffness="k_throw", damping="c_throw"),
        tn.Spring("s6", nodes=("c6", "fly"), stiffness=K_FLYWHEEL, damping="c_throw"),
        tn.Inertia("flywheel", node="fly", inertia=J_FLYWHEEL),
        tn.Spring("coupling", nodes=("fly", "load"), stiffness="k_cpl", damping="c_cpl"),
        tn.Inertia("rotor", node="load", inertia=J_LOAD),
    ]
    table = {order: {"amplitude": size, "phase": phase} for order, (size, phase) in HARMONICS.items()}
    motored = {order: {"amplitude": MOTORED * size, "phase": phase} for order, (size, phase) in HARMONICS.items()}
    return tn.Drivetrain(
        "small engine",
        elements,
        parameters={
            "J_c": J_CYLINDER, "J_nose": 0.03, "k_throw": K_THROW, "c_throw": C_THROW, "k_cpl": K_COUPLING,
            "c_cpl": C_COUPLING, **parameters,
        },
        sensors={"T_cpl": {"torque": "coupling"}, "T_crank": {"torque": "s4"}, "phi": {"angle": "nose"}},
        speeds={"of": "fly", "list": ["1500 rpm"]},
        excitations={
            "engine": {
                "type": "reciprocating_engine", "speed_of": "fly", "cycle": 4,
                "cylinders": {str(number): f"c{number}" for number in range(1, 7)}, "firing_order": list(FIRING),
                "bore": BORE, "stroke": STROKE, "rod_length": 0.22,
                "gas": {"harmonics": table, "motored_harmonics": motored}, "orders": list(HARMONICS),
            }
        },
    )  # fmt: skip


def dense_orders(output="T_cpl", misfire=None, corrections=None, speeds=SPEEDS, k_cpl=K_COUPLING, c_throw=C_THROW):
    """Complex orders (n_orders, n_speeds) of a torque in N m, from M, C and K and a Fourier sum of tangential forces."""
    inertias = [0.03, *[J_CYLINDER] * 6, J_FLYWHEEL, J_LOAD]
    springs = [K_THROW] * 6 + [K_FLYWHEEL, k_cpl]
    dampers = [c_throw] * 7 + [C_COUPLING]
    M, C, K = np.diag(inertias), np.zeros((9, 9)), np.zeros((9, 9))
    for number, (k, c) in enumerate(zip(springs, dampers, strict=True)):
        row = np.zeros(9)
        row[number], row[number + 1] = 1, -1
        K += k * np.outer(row, row)
        C += c * np.outer(row, row)
    area_radius = np.pi * BORE**2 / 4 * STROKE / 2
    first, second = TWISTS[output]
    k, c = springs[first], dampers[first]
    torques = np.zeros((len(HARMONICS), len(speeds)), dtype=complex)
    for place, (order, (size, phase)) in enumerate(HARMONICS.items()):
        torque = np.zeros(9, dtype=complex)
        for position, cylinder in enumerate(FIRING):
            share = (misfire or {}).get(cylinder, 0.0)
            factor = (corrections or {}).get(order, 1.0) * (1 - share) + MOTORED * share
            shift = np.exp(-1j * order * position * 4 * np.pi / 6)
            torque[cylinder] = area_radius * size * np.exp(1j * phase) * factor * shift
        for at, speed in enumerate(speeds):
            omega = order * speed
            motion = np.linalg.solve(K + 1j * omega * C - omega**2 * M, torque)
            torques[place, at] = (k + 1j * omega * c) * (motion[first] - motion[second])
    return torques


def tracked(values, sigma, seed, output="T_cpl", reference="top dead centre of cylinder 1", turned=0.0, speeds=SPEEDS):
    """Tracked orders with independent noise of the deviation ``sigma`` in real and imaginary part, N m."""
    rng, orders = np.random.default_rng(seed), np.array(list(HARMONICS))
    noise = rng.normal(size=values.shape) + 1j * rng.normal(size=values.shape)
    measured = values * np.exp(1j * orders[:, None] * turned) + sigma * noise
    widths = np.full(values.shape, 1.959964 * sigma)
    times = np.arange(float(len(speeds)))
    return TrackedOrders(output, "torque", orders, times, speeds, measured, widths, reference=reference)
