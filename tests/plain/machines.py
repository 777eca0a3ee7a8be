"""Machines, vehicles and hydraulics, out of the page on elements."""

from __future__ import annotations

from collections.abc import Sequence

from flint import acb

from plain.component import Component, Draw, Equations, Law, inertia, pi, spring, straight, twist


def propeller(d: Draw, name: str, a: str) -> Component:
    J, Q, n = d.J, d.number(10, 500), d.number(5, 60)
    entries = {"type": "propeller", "node": a, "inertia": J}
    water, design, pitch = d.number(0.1, 0.4), d.number(0.7, 1.2), d.number(0.2, 1.3)
    J_w = d.J
    form = d.pick("share", "pitch", "inertia")
    entries |= {"entrained_inertia": J_w} if form == "inertia" else {"entrained_water": water}
    entries |= {"pitch_ratio": pitch, "design_pitch_ratio": design} if form == "pitch" else {}
    law = d.pick("damping", "archer", "exponent", "torque_slope")
    x, K_Q, J_a = (
        d.number(1, 40) if law != "torque_slope" else -d.plain(0.01, 0.06),
        d.plain(0.02, 0.06),
        d.plain(0.2, 0.9),
    )
    entries[law] = x
    if law != "damping":
        entries |= {"torque": Q, "speed": n}
    if law == "torque_slope":
        entries |= {"torque_coefficient": K_Q, "advance_ratio": J_a}

    def equations(v):
        whole = v(J) + v(J_w) if form == "inertia" else v(J) * (1 + v(water))
        if form == "pitch":
            seven = (v(7) / 10 * pi()) ** 2
            p, design_ = v(pitch) ** 2, v(design) ** 2
            whole = v(J) * (1 + v(water) * p * (design_ + seven) / (design_ * (p + seven)))
        c = {
            "damping": lambda: v(x),
            "archer": lambda: v(x) * v(Q) * pi() / (30 * v(n)),
            "exponent": lambda: v(x) * v(Q) / v(n),
            "torque_slope": lambda: (2 - v(J_a) / v(K_Q) * v(x)) * v(Q) / v(n),
        }[law]()
        return Equations([inertia(a, whole), Law({a: 1}, lambda s: c * s)])

    return Component(entries, equations, a)


def synchronous(d: Draw, name: str, a: str) -> Component:
    T_e, p, T, T_r, J, c, k = (
        d.number(300, 3e3),
        d.chance.randint(1, 8),
        d.number(20, 250),
        d.number(5, 60),
        d.J,
        d.c,
        d.k,
    )
    angle, form = d.plain(0.1, 0.7), d.pick("k", "torque", "angle", "salient")
    entries = {"type": "synchronous_machine", "node": a, "damping": c, "inertia": J}
    entries |= {
        "k": {"stiffness": k},
        "torque": {"pull_out_torque": T_e, "pole_pairs": p, "torque": T},
        "angle": {"pull_out_torque": T_e, "pole_pairs": p, "load_angle": angle},
        "salient": {"pull_out_torque": T_e, "pole_pairs": p, "load_angle": angle, "reluctance_torque": T_r},
    }[form]

    def equations(v):
        stiffness = {
            "k": lambda: v(k),
            "torque": lambda: p * (v(T_e) ** 2 - v(T) ** 2).sqrt(),
            "angle": lambda: p * v(T_e) * v(angle).cos(),
            "salient": lambda: p * (v(T_e) * v(angle).cos() + 2 * v(T_r) * (2 * v(angle)).cos()),
        }[form]()
        return Equations([inertia(a, v(J)), spring(a, "ground", stiffness, v(c))])

    return Component(entries, equations, a)


def induction(d: Draw, name: str, a: str) -> Component:
    w, T_k, s_k, s0 = d.number(50, 320), d.number(300, 900), d.number(0.05, 0.2), d.plain(0.005, 0.3)
    T_n, s_n, tau, J = d.number(100, 250), d.number(0.01, 0.04), d.number(0.005, 0.1), d.J
    rated, lags = d.sometimes(0.4), d.sometimes(0.5)
    entries = {"type": "induction_machine", "node": a, "synchronous_speed": w, "breakdown_torque": T_k, "inertia": J}
    entries |= {"rated_torque": T_n, "rated_slip": s_n} if rated else {"breakdown_slip": s_k, "slip": s0}
    lags = lags and (rated or d.parameters.get(s_k, s_k) > s0)
    entries |= {"time_constant": tau} if lags else {}

    def equations(v):
        if rated:
            m = v(T_k) / v(T_n)
            breakdown, slip = v(s_n) * (m + (m * m - 1).sqrt()), v(s_n)
        else:
            breakdown, slip = v(s_k), v(s0)
        c = 2 * v(T_k) * breakdown * (breakdown**2 - slip**2) / (v(w) * (slip**2 + breakdown**2) ** 2)
        lag = v(tau) if lags else v(0)
        return Equations([inertia(a, v(J)), Law({a: 1}, lambda s: c * s / (1 + lag * s))])

    return Component(entries, equations, a, roots=lambda v: [-1 / v(tau)] if lags else [])


def grid_generator(d: Draw, name: str, a: str) -> Component:
    f, pairs = d.pick(50, 60), d.pick(1, 2, 3)
    S, w, H, K_s, K_D = d.number(1e3, 1e5), f"{60 * f // pairs} rpm", d.number(1, 5), d.number(0.4, 2), d.number(1, 20)
    E, V, X, P, given = d.number(1.1, 1.5), 1.0, d.number(0.3, 0.6), d.number(0.2, 0.9), d.sometimes(0.5)
    entries = {"type": "grid_generator", "node": a, "rated_power": S, "speed": w, "grid_frequency": f}
    entries |= {"inertia_constant": H, "damping_coefficient": K_D}
    entries |= (
        {"synchronising_coefficient": K_s} if given else {"emf": E, "grid_voltage": V, "reactance": X, "power": P}
    )

    def equations(v):
        coefficient = v(K_s) if given else ((v(E) * v(V) / v(X)) ** 2 - v(P) ** 2).sqrt()
        unit = v(S) / (2 * pi() * f / pairs) ** 2
        k = coefficient * unit * 2 * pi() * f
        return Equations([inertia(a, 2 * v(H) * unit), spring(a, "ground", k, v(K_D) * unit)])

    return Component(entries, equations, a)


def constant_power(d: Draw, name: str, a: str) -> Component:
    P, w = d.number(100, 5e4) if d.sometimes(0.6) else -d.plain(100, 5e4), d.number(30, 300)
    entries = {"type": "constant_power_load", "node": a, "power": P, "speed": w}
    return Component(entries, lambda v: Equations([Law({a: 1}, lambda s: -v(P) / v(w) ** 2 * s)]), a)


def vehicle(d: Draw, name: str, a: str) -> Component:
    m, r, J_w, speed = d.number(20, 200), d.number(0.25, 0.4), d.J, d.number(5, 40)
    A, rho, f1 = d.number(0.3, 3), d.number(1, 1.3), d.number(1e-5, 1e-3)
    entries = {"type": "vehicle", "node": a, "mass": m, "wheel_radius": r, "wheel_inertia": J_w, "speed": speed}
    entries |= {"drag_area": A, "air_density": rho, "rolling_slope": f1}

    def equations(v):
        r2 = v(r) ** 2
        c = r2 * (v(rho) * v(A) * v(speed) + v(m) * v(980665) / 100000 * v(f1))
        return Equations([inertia(a, v(m) * r2 + v(J_w)), Law({a: 1}, lambda s: c * s)])

    return Component(entries, equations, a)


def tyre(d: Draw, name: str, a: str, b: str) -> Component:
    r, C, speed, k, sigma = (
        d.number(0.25, 0.4),
        d.number(2e4, 2e5),
        d.number(1, 50),
        d.number(5e3, 5e4),
        d.number(0.1, 0.6),
    )
    damping, J, form = d.number(1, 100), d.number(0.05, 1), d.pick("k", "sigma", "standing")
    entries = {"type": "tyre", "nodes": [a, b]}
    if form == "standing":
        entries |= {"state": "standing", "stiffness": k}
    else:
        entries |= {"radius": r, "slip_stiffness": C, "speed": speed}
        entries |= {"stiffness": k} if form == "k" else {"relaxation_length": sigma}
    entries |= {"damping": damping} if d.sometimes(0.5) else {}
    massive = form != "standing" and d.sometimes(0.5)
    entries |= {"belt_inertia": J} if massive else {}
    belt = f"{name}.belt"

    def equations(v):
        if form == "standing":
            return Equations([spring(a, b, v(k), v(entries.get("damping", 0)))])
        grip = v(C) * v(r) ** 2
        stiffness = v(k) if form == "k" else grip / v(sigma)
        laws = [
            spring(a, belt, stiffness, v(entries.get("damping", 0))),
            Law(twist(belt, b), lambda s: grip / v(speed) * s),
        ]
        return Equations(laws + ([inertia(belt, v(J))] if massive else []))

    return Component(entries, equations, a)


def hydraulic(d: Draw, name: str, a: str, b: str) -> Component:
    """Converter or coupling: both torques from C(nu) and E(nu) = mu C, with their slopes."""
    converter, w, nu = d.sometimes(0.6), d.number(80, 250), d.plain(0.2, 0.9)
    ratios = [0, d.plain(0.3, 0.5), d.plain(0.55, 0.8), 1]
    nu = nu if nu not in ratios else nu + 0.001
    form, J_p, J_t = d.pick("pump_torque", "performance", "k_factor"), d.J, d.J
    test, D, rho = d.number(100, 250), d.number(0.2, 0.3), d.number(800, 900)
    spans = {"pump_torque": (20, 200), "performance": (0.001, 0.004), "k_factor": (80, 300)}[form]
    rows, mu = [(n, d.plain(*spans)) for n in ratios], [(n, d.plain(0.8, 2.5)) for n in ratios]
    entries = {"type": "torque_converter" if converter else "fluid_coupling", "pump": a, "turbine": b, "speed": w}
    entries |= {"speed_ratio": nu, form: [list(row) for row in rows], "pump_inertia": J_p, "turbine_inertia": J_t}
    entries |= {"pump_torque": {"test_speed": test}, "performance": {"diameter": D, "density": rho}}.get(form, {})
    entries |= {"torque_ratio": [list(row) for row in mu]} if converter else {}

    def equations(v):
        y, slope = (acb(one) for one in straight(rows, nu))
        if form == "k_factor":
            unit = 30 / pi()  # (r/min) per rad/s
            C, C1 = (unit / y) ** 2, -2 * unit**2 * slope / y**3
        else:
            scale = 1 / v(test) ** 2 if form == "pump_torque" else v(rho) * v(D) ** 5
            C, C1 = y * scale, slope * scale
        m, m1 = (acb(one) for one in straight(mu, nu)) if converter else (acb(1), acb(0))
        E, E1 = m * C, m1 * C + m * C1
        p = v(w)
        pump, turbine = {a: p * (2 * C - nu * C1), b: p * C1}, {a: p * (2 * E - nu * E1), b: p * E1}
        laws = [Law({a: 1}, lambda s: s, pump), Law({b: -1}, lambda s: s, turbine)]
        return Equations([*laws, inertia(a, v(J_p)), inertia(b, v(J_t))])

    return Component(entries, equations, a)


AT_A_NODE = (propeller, synchronous, induction, grid_generator, constant_power, vehicle)
THROUGH: Sequence = (tyre, hydraulic)
