"""Flexible couplings, dampers, flywheels and shafts, out of the page on elements."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

from flint import acb, arb

from plain.component import Component, Draw, Equations, Law, hertz, inertia, pi, powers, spring, straight, twist


def _curve(d: Draw, low: float, high: float, xs: Sequence[float]) -> list[tuple[float, float]]:
    return [(x, d.plain(low, high)) for x in xs]


def flexible_coupling(d: Draw, name: str, a: str, b: str) -> Component:
    J1, J2, series, parallel = d.J, d.J, d.pick(1, 2, 3), d.pick(1, 2)
    entries = {"type": "flexible_coupling", "nodes": [a, b], "first_inertia": J1, "second_inertia": J2}
    form = d.pick("sheet", "frequency", "material")
    k, c, eta, scale = d.k, d.c, d.number(0.05, 0.3), d.number(0.5, 2)
    if form == "material":
        return _of_material(d, entries, scale, lambda v: [inertia(a, v(J1)), inertia(b, v(J2))])
    entries |= {"in_series": series, "in_parallel": parallel}
    ends = lambda v: [inertia(a, v(J1)), inertia(b, v(J2))]  # noqa: E731
    if form == "frequency":
        factor, loss = _curve(d, 0.7, 2, (1.0, 30.0, 400.0)), _curve(d, 0.05, 0.3, (2.0, 100.0))
        entries |= {"stiffness": k, "frequency_factor": {f"{x} Hz": y for x, y in factor}}
        entries |= {"loss_over_frequency": {f"{x} Hz": y for x, y in loss}}

        def over_frequency(v):
            def kappa(s):
                f = hertz(s)
                return v(k) * parallel / series * powers(factor, f) * (1 + 1j * acb(powers(loss, f)))

            return Equations([Law(twist(a, b), kappa), *ends(v)])

        return Component(entries, over_frequency, a, is_rational=False)
    T_KN, torque, vibratory = d.plain(100, 2000), d.plain(10, 90), d.plain(1, 9)
    over = _curve(d, 1e3, 1e6, (0.0, 0.25, 0.6, 1.0))
    S_T, S_A = _curve(d, 0.8, 3, (0.0, 0.5, 1.0)), _curve(d, 0.8, 1.2, (0.0, 0.3))
    S_t, S_d, celsius = _curve(d, 0.5, 1, (20.0, 60.0, 100.0)), _curve(d, 0.5, 1.5, (20.0, 100.0)), d.plain(25, 95)
    read = d.sometimes(0.5)
    entries |= {"T_KN": T_KN, "torque": torque, "vibratory_torque": vibratory, "temperature": f"{celsius} degC"}
    entries |= {"stiffness_over_torque": dict(over)} if read else {"stiffness": k, "torque_factor": dict(S_T)}
    entries |= {"amplitude_factor": dict(S_A), "temperature_factor": {f"{x} degC": y for x, y in S_t}}
    viscous = d.sometimes(0.3)
    psi = d.number(0.2, 1.5)
    entries |= {"damping": c} if viscous else {"loss_factor": d.pick(eta, {"psi": psi})}
    if not viscous:
        entries["damping_temperature_factor"] = {f"{x} degC": y for x, y in S_d}

    def sheet(v):
        share = torque / T_KN
        stiffness = acb(straight(over, share)[0]) if read else v(k) * straight(S_T, share)[0]
        stiffness = stiffness * straight(S_A, vibratory / T_KN)[0] * straight(S_t, celsius)[0] * parallel / series
        if viscous:
            return Equations([spring(a, b, stiffness, v(c) * parallel / series), *ends(v)])
        given = entries["loss_factor"]
        loss = v(psi) / (2 * pi()) if isinstance(given, dict) else v(eta)
        return Equations(
            [Law(twist(a, b), lambda s: stiffness * (1 + 1j * loss * straight(S_d, celsius)[0])), *ends(v)]
        )

    return Component(entries, sheet, a, is_rational=viscous)


def _moduli(d: Draw) -> tuple[dict, callable]:
    """Rows and a shift; the moduli at a frequency in Hz."""
    rows = [(f, d.plain(1e5, 5e5), d.plain(1e4, 1e5)) for f in (0.001, 1.0, 50.0, 1e5)]
    reference, celsius = d.plain(20, 40), d.plain(20, 60)
    C1, C2 = 8.86, 101.6
    material = {"moduli": [[f"{f} Hz", f"{G} Pa", f"{loss} Pa"] for f, G, loss in rows]}
    material |= {"reference_temperature": f"{reference} degC", "C1": C1, "C2": f"{C2} K"}
    shift = arb(10) ** (-arb(C1) * (arb(celsius) - reference) / (arb(C2) + celsius - reference))

    def modulus(f: arb) -> acb:
        storage, loss = ([(row[0], row[i]) for row in rows] for i in (1, 2))
        return acb(powers(storage, f * shift), powers(loss, f * shift))

    return {"material": material, "temperature": f"{celsius} degC"}, modulus


def _of_material(d: Draw, entries: dict, scale, ends) -> Component:
    (a, b), (given, modulus) = entries["nodes"], _moduli(d)
    outer, inner, thick = d.plain(0.3, 0.5), d.plain(0.1, 0.25), d.plain(0.02, 0.1)
    disc = d.sometimes(0.5)
    shape = {"type": "disc", "thickness": thick} if disc else {"type": "bush", "length": thick}
    entries = entries | given | {"scale": scale, "geometry": shape | {"outer_diameter": outer, "inner_diameter": inner}}

    def equations(v):
        ro, ri, t = acb(outer) / 2, acb(inner) / 2, acb(thick)
        size = pi() * (ro**4 - ri**4) / (2 * t) if disc else 4 * pi() * t / (1 / ri**2 - 1 / ro**2)
        return Equations([Law(twist(a, b), lambda s: v(scale) * size * modulus(hertz(s))), *ends(v)])

    return Component(entries, equations, a, is_rational=False)


def viscous_damper(d: Draw, name: str, a: str) -> Component:
    J_r, J_h, c, k, scale = d.J, d.J, d.c, d.number(10, 1e4), d.number(0.5, 2)
    ring, form = f"{name}.ring", d.pick("constant", "table", "silicone")
    entries = {"type": "viscous_damper", "node": a, "ring_inertia": J_r, "hub_inertia": J_h}
    if form == "constant":
        entries |= {"damping": c, "stiffness": k} if d.sometimes(0.5) else {"damping": c}
        return Component(
            entries,
            lambda v: Equations(
                [inertia(a, v(J_h)), inertia(ring, v(J_r)), spring(a, ring, v(entries.get("stiffness", 0)), v(c))]
            ),
            a,
        )
    if form == "table":
        rows = [(f, d.plain(10, 1e4), d.plain(1, 100)) for f in (1.0, 20.0, 90.0, 400.0)]
        entries |= {"table": [list(row) for row in rows], "scale": scale}

        def film(v, s):
            f = hertz(s)
            found = [_lines([(row[0], row[i]) for row in rows], f) for i in (1, 2)]
            return v(scale) * (acb(found[0]) + s * acb(found[1]))
    else:
        given, modulus = _moduli(d)
        ro, ri, h_a, width, h_o, h_i = 0.19, 0.12, 0.0006, 0.05, 0.0007, 0.0008
        gap = {"outer_diameter": 2 * ro, "inner_diameter": 2 * ri, "axial_gap": h_a, "width": width, "outer_gap": h_o}
        has_inner = d.sometimes(0.5)
        gap |= {"inner_gap": h_i} if has_inner else {}
        entries |= {"silicone": given["material"], "temperature": given["temperature"], "gap": gap, "scale": scale}

        def film(v, s):
            outer, inner = arb(2 * ro) / 2, arb(2 * ri) / 2
            size = arb.pi() * (outer**4 - inner**4) / arb(h_a) + 2 * arb.pi() * arb(width) * outer**3 / arb(h_o)
            size += 2 * arb.pi() * arb(width) * inner**3 / arb(h_i) if has_inner else 0
            return v(scale) * size * modulus(hertz(s))

    def equations(v):
        return Equations([inertia(a, v(J_h)), inertia(ring, v(J_r)), Law(twist(a, ring), lambda s: film(v, s))])

    return Component(entries, equations, a, is_rational=False)


def _lines(rows: Sequence[tuple[float, float]], f: arb) -> arb:
    """Straight between the rows, constant beyond."""
    if not f > rows[0][0]:
        return arb(rows[0][1])
    for (x0, y0), (x1, y1) in pairwise(rows):
        if not f > x1:
            return arb(y0) + (arb(y1) - y0) * (f - x0) / (arb(x1) - x0)
    return arb(rows[-1][1])


def tuned_damper(d: Draw, name: str, a: str) -> Component:
    J_r, J_h, k, f, eta, zeta, c = d.J, d.J, d.k, d.number(2, 80), d.number(0.02, 0.3), d.number(0.02, 0.3), d.c
    ring, stiff, loss = f"{name}.ring", d.pick("k", "f"), d.pick("eta", "zeta", "c")
    entries = {"type": "tuned_damper", "node": a, "ring_inertia": J_r, "hub_inertia": J_h}
    entries |= {"stiffness": k} if stiff == "k" else {"natural_frequency": f}
    entries |= {"eta": {"loss_factor": eta}, "zeta": {"damping_ratio": zeta}, "c": {"damping": c}}[loss]

    def equations(v):
        stiffness = v(k) if stiff == "k" else v(J_r) * (2 * pi() * v(f)) ** 2
        damping = v(c) if loss == "c" else 2 * v(zeta) * (stiffness * v(J_r)).sqrt()
        layer = Law(
            twist(a, ring), lambda s: stiffness * (1 + 1j * v(eta)) if loss == "eta" else stiffness + damping * s
        )
        return Equations([layer, inertia(a, v(J_h)), inertia(ring, v(J_r))])

    return Component(entries, equations, a, is_rational=loss != "eta")


def spring_damper(d: Draw, name: str, a: str) -> Component:
    J_r, J_h, k, c, over = d.J, d.J, d.k, d.c, d.sometimes(0.6)
    ring, factor, loss = f"{name}.ring", _curve(d, 0.8, 2, (1.0, 40.0, 300.0)), _curve(d, 0.1, 0.8, (3.0, 60.0))
    entries = {"type": "spring_damper", "node": a, "ring_inertia": J_r, "hub_inertia": J_h, "stiffness": k}
    if over:
        entries |= {"loss_over_frequency": {f"{x} Hz": y for x, y in loss}}
        entries |= {"stiffness_over_frequency": {f"{x} Hz": y for x, y in factor}}
    else:
        entries["damping"] = c

    def equations(v):
        def kappa(s):
            if not over:
                return v(k) + v(c) * s
            return v(k) * powers(factor, hertz(s)) * (1 + 1j * acb(powers(loss, hertz(s))))

        return Equations([Law(twist(a, ring), kappa), inertia(a, v(J_h)), inertia(ring, v(J_r))])

    return Component(entries, equations, a, is_rational=not over)


def pendulum(d: Draw, name: str, a: str) -> Component:
    m, R, r, w, c, J = (
        d.number(0.1, 3),
        d.number(0.05, 0.3),
        d.number(0.005, 0.05),
        d.number(10, 200),
        d.number(0.01, 1),
        d.number(1e-4, 1e-2),
    )
    count, swing, path, simple = (
        d.pick(1, 4, 6),
        d.number(0.1, 0.6),
        d.pick("circle", "cycloid", "epicycloid"),
        d.sometimes(0.3),
    )
    entries = {
        "type": "pendulum_absorber",
        "node": a,
        "mass": m,
        "pivot_radius": R,
        "path_radius": r,
        "speed": w,
        "count": count,
    }
    entries |= {"own_inertia": J} if d.sometimes(0.6) else {}
    entries |= {"suspension": "simple"} if simple else {}
    entries |= {"damping": c} if d.sometimes(0.6) else {}
    entries |= {"path": path, "swing": swing} if d.sometimes(0.6) and not simple else {}
    mass = f"{name}.mass"

    def equations(v):
        n2 = v(R) / v(r)
        lam2 = {"circle": 0, "cycloid": 1, "epicycloid": n2 / (1 + n2)}[entries.get("path", "circle")]
        alpha2 = v(entries["swing"]) ** 2 if "swing" in entries else v(0)
        k = v(m) * v(R) * v(r) * v(w) ** 2 * (1 - (1 - lam2 * (1 + n2) / n2) * alpha2 / 8) * count
        own = inertia(mass if simple else a, count * v(entries.get("own_inertia", 0)))
        return Equations([
            spring(a, mass, k, v(entries.get("damping", 0))),
            Law({a: v(R), mass: v(r)}, lambda s: count * v(m) * s * s), own,
        ])  # fmt: skip

    return Component(entries, equations, a)


def flywheel(d: Draw, name: str, a: str, b: str) -> Component:
    J1, J2, k, blocked, eta, c, M = d.J, d.J, d.k, d.number(0.1, 0.5), d.number(0.02, 0.2), d.c, d.number(1, 20)
    swing, mu, m, r, w = (
        d.number(0.02, 0.2),
        d.number(0.05, 0.2),
        d.number(0.3, 1),
        d.number(0.08, 0.15),
        d.number(50, 300),
    )
    k1, k2, T1, T, staged = d.plain(300, 900), d.plain(1000, 3000), d.plain(50, 150), d.plain(10, 400), d.sometimes(0.5)
    entries = {"type": "dual_mass_flywheel", "nodes": [a, b], "primary_inertia": J1, "secondary_inertia": J2}
    entries |= (
        {"stages": [{"stiffness": k1, "to": f"{T1} N*m"}, {"stiffness": k2}], "torque": T}
        if staged
        else {"stiffness": k}
    )
    entries |= {"blocked": blocked} if d.sometimes(0.5) else {}
    entries |= {"loss_factor": eta} if d.sometimes(0.5) else {}
    entries |= {"damping": c} if d.sometimes(0.5) else {}
    rubs = d.sometimes(0.6)
    entries |= {"friction": M, "swing": swing} if rubs else {}
    outward = rubs and d.sometimes(0.5)
    if outward:
        entries |= {"friction_coefficient": mu, "spring_mass": m, "spring_radius": r, "speed": w}

    def equations(v):
        stiffness = v(k) if not staged else v(k1 if T <= T1 else k2)
        stiffness = stiffness / (1 - v(entries.get("blocked", 0)))
        friction = v(M) + (v(mu) * v(m) * v(r) ** 2 * v(w) ** 2 if outward else 0)
        loss = v(entries.get("loss_factor", 0)) + (4 * friction / (pi() * stiffness * v(swing)) if rubs else 0)
        law = Law(twist(a, b), lambda s: stiffness * (1 + 1j * loss) + v(entries.get("damping", 0)) * s)
        return Equations([law, inertia(a, v(J1)), inertia(b, v(J2))])

    return Component(entries, equations, a, is_rational=not rubs and "loss_factor" not in entries)


def crank_throw(d: Draw, name: str, a: str, b: str) -> Component:
    J, k, c, cz = d.J, d.k, d.c, d.c
    r, m_r, m_o, rod = d.number(0.03, 0.1), d.number(0.5, 3), d.number(0.5, 3), d.number(0.15, 0.3)
    entries = {"type": "crank_throw", "nodes": [a, b], "inertia": J, "crank_radius": r, "rotating_mass": m_r}
    entries |= {"reciprocating_mass": m_o, "damping": c, "cylinder_damping": cz}
    entries |= {"rod_length": rod} if d.sometimes(0.7) else {}
    given = d.sometimes(0.5)
    D, L, P, Lp, width, thick, bore = (d.number(*span) for span in (
        (0.05, 0.09), (0.03, 0.06), (0.05, 0.08), (0.03, 0.06), (0.08, 0.12), (0.02, 0.04), (0.005, 0.02)))  # fmt: skip
    entries |= {"stiffness": k} if given else {
        "journal_diameter": D, "journal_length": L, "pin_diameter": P, "pin_length": Lp, "web_width": width,
        "web_thickness": thick, "journal_bore": bore, "pin_bore": bore, "shear_modulus": 8e10, "elastic_modulus": 2e11,
    }  # fmt: skip

    def equations(v):
        lam2 = (v(r) / v(rod)) ** 2 if "rod_length" in entries else acb(0)
        whole = v(J) + v(r) ** 2 * (v(m_r) + v(m_o) * (acb(1) / 2 + lam2 / 8))
        I_j, I_p = (pi() * (v(one) ** 4 - v(bore) ** 4) / 32 for one in (D, P))
        I_w = v(thick) * v(width) ** 3 / 12
        soft = v(L) / (8e10 * I_j) + v(Lp) / (8e10 * I_p) + 2 * v(r) / (2e11 * I_w)
        stiffness = v(k) if given else 1 / soft
        return Equations([spring(a, b, stiffness, v(c)), inertia(a, whole), Law({a: 1}, lambda s: v(cz) * s)])

    return Component(entries, equations, a)


def continuous_shaft(d: Draw, name: str, a: str, b: str) -> Component:
    D, L, G, rho, eta = (
        d.number(0.04, 0.1),
        d.number(0.3, 20),
        d.number(7e10, 8.5e10),
        d.number(7000, 8000),
        d.number(0.005, 0.05),
    )
    bore, lossy = d.number(0.01, 0.03), d.sometimes(0.5)
    entries = {
        "type": "continuous_shaft",
        "nodes": [a, b],
        "outer_diameter": D,
        "length": L,
        "shear_modulus": G,
        "density": rho,
    }
    entries |= {"inner_diameter": bore} if d.sometimes(0.5) else {}
    entries |= {"loss_factor": eta} if lossy else {}

    def equations(v):
        area = pi() * (v(D) ** 4 - v(entries.get("inner_diameter", 0)) ** 4) / 32
        modulus = v(G) * (1 + 1j * v(eta)) if lossy else v(G)

        def wave(s):
            # theta'' = s^2 rho/G theta: k x cot x and k x/sin x with x = omega L sqrt(rho/G).
            q = s * (v(rho) / modulus).sqrt()
            return modulus * area * q, q * v(L)

        # k x cot x = own - joined, with what joins the ends: k x / sin x.
        joined = lambda s: wave(s)[0] / wave(s)[1].sinh()  # noqa: E731
        own = lambda s: wave(s)[0] * ((wave(s)[1]).cosh() - 1) / wave(s)[1].sinh()  # noqa: E731
        return Equations([Law(twist(a, b), joined), Law({a: 1}, own), Law({b: 1}, own)])

    return Component(entries, equations, a, is_rational=False)


AT_A_NODE = (viscous_damper, tuned_damper, spring_damper, pendulum)
THROUGH = (flexible_coupling, flywheel, crank_throw, continuous_shaft)
