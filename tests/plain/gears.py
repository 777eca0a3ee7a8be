"""Couplings, gears and drives between shafts, out of the page on elements."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import pairwise

from plain.component import Component, Draw, Equations, Law, combined, inertia, pi, spring, straight, twist


def plain_spring(d: Draw, name: str, a: str, b: str) -> Component:
    k, more = d.k, d.maybe(0.6, "damping", 0.2, 200)
    return Component(
        {"type": "spring", "nodes": [a, b], "stiffness": k, **more},
        lambda v: Equations([spring(a, b, v(k), v(more.get("damping", 0)))]),
        a,
    )


def rubber(d: Draw, name: str, a: str, b: str) -> Component:
    k, eta = d.k, d.number(0.02, 0.4)
    return Component(
        {"type": "hysteretic_spring", "nodes": [a, b], "stiffness": k, "loss_factor": eta},
        lambda v: Equations([Law(twist(a, b), lambda s: v(k) * (1 + 1j * v(eta)))]),
        a,
        is_rational=False,
    )


def gear(d: Draw, name: str, a: str, b: str) -> Component:
    tau, k, c = d.number(0.3, 4), d.k, d.c
    mesh = d.pick({}, {"stiffness": k}, {"stiffness": k, "damping": c})

    def equations(v):
        row = {a: 1, b: -v(tau)}
        if not mesh:
            return Equations(held=[row])
        return Equations([Law(row, lambda s: v(k) + v(mesh.get("damping", 0)) * s)])

    return Component({"type": "gear", "nodes": [a, b], "ratio": tau, **mesh}, equations, a)


def clutch(d: Draw, name: str, a: str, b: str) -> Component:
    state = d.pick("closed", "open", "slipping")
    entries = {"type": "clutch", "nodes": [a, b], "state": state}
    drag, J1, Jd, k, c = d.number(0.1, 5), d.J, d.J, d.k, d.c
    springs = d.pick({}, {"stiffness": k}, {"stiffness": k, "damping": c})
    bodies = d.pick({}, {"first_inertia": J1}, {"first_inertia": J1, "disc_inertia": Jd})
    entries |= springs | bodies
    slope, scale = 0.0, 1
    if state == "open" or d.sometimes(0.3):
        entries["drag"] = drag
    if state == "slipping":
        speeds = [0.0, *d.rows(5, 300, 3)]
        at = sum(speeds[:2]) / 2 if d.sometimes(0.5) else (speeds[-1] + speeds[-2]) / 2
        entries["slip_speed"] = -at if d.sometimes(0.3) else at
        if d.sometimes(0.5):
            rows = [(n, d.plain(100, 300)) for n in speeds]
            entries["torque"] = [[f"{n} rad/s", f"{T} N*m"] for n, T in rows]
        else:
            scale = d.number(500, 2000)
            rows = [(n, d.plain(0.08, 0.2)) for n in speeds]
            entries |= {"friction": [[f"{n} rad/s", mu] for n, mu in rows], "clamp_torque": scale}
        slope = straight(rows, at)[1]

    def equations(v):
        disc = f"{name}.disc" if springs else b
        laws = [spring(disc, b, v(k), v(springs.get("damping", 0)))] if springs else []
        laws += [inertia(a, v(J1))] if "first_inertia" in bodies else []
        laws += [inertia(disc, v(Jd))] if "disc_inertia" in bodies else []
        if state == "closed":
            return Equations(laws, [twist(a, disc)])
        passed = v(drag) if state == "open" else v(scale) * slope
        return Equations([Law(twist(a, disc), lambda s: passed * s), *laws])

    return Component(entries, equations, a)


def gearbox(d: Draw, name: str, a: str, b: str) -> Component:
    names = ["I", "II", "R"][: d.pick(2, 3)]
    teeth = d.sometimes(0.4)
    counts = {one: [d.chance.randint(14, 40), d.pick(1, -1) * d.chance.randint(14, 60)] for one in names}
    ratios = {one: d.number(0.6, 4) if d.sometimes(0.6) else -d.plain(0.6, 4) for one in names}
    engaged, loose = d.pick(*names, "neutral"), d.pick("output", "input")
    J_in, J_out, wheels, k, c = d.J, d.J, dict.fromkeys(names, d.J), dict.fromkeys(names, d.k), d.c
    entries = {"type": "gearbox", "input": a, "output": b, "engaged": engaged, "loose_wheels": loose}
    entries |= {"teeth": counts} if teeth else {"ratios": ratios}
    entries |= {"wheel_inertias": wheels, "input_inertia": J_in, "output_inertia": J_out}
    elastic = names[: d.pick(0, 1, len(names))]
    if elastic:
        entries |= {"stiffness": {one: k[one] for one in elastic}}
        entries |= {"damping": c} if d.sometimes(0.5) else {}

    def equations(v):
        laws, held = [inertia(a, v(J_in)), inertia(b, v(J_out))], []
        for one in names:
            wheel = f"{name}.{one}"
            tau = v(counts[one][1]) / counts[one][0] if teeth else v(ratios[one])
            row = {a: 1, wheel: -tau} if loose == "output" else {wheel: 1, b: -tau}
            laws.append(inertia(wheel, v(wheels[one])))
            if one in elastic:
                laws.append(Law(row, lambda s, one=one: v(k[one]) + v(entries.get("damping", 0)) * s))
            else:
                held.append(row)
        if engaged != "neutral":
            held.append(twist(f"{name}.{engaged}", b if loose == "output" else a))
        return Equations(laws, held)

    return Component(entries, equations, a)


def final_drive(d: Draw, name: str, a: str, b: str, other: str) -> Component:
    tau, kind = d.number(2, 5), d.pick("open", "locked", "limited-slip")
    slip, J_p, J_c, k, c = d.c, d.J, d.J, d.k, d.c
    mesh = d.pick({}, {"stiffness": k, "damping": c})
    entries = {"type": "final_drive", "pinion": a, "left": b, "right": other, "ratio": tau, "differential": kind}
    entries |= {"pinion_inertia": J_p, "cage_inertia": J_c, **mesh}
    entries |= {"slip_damping": slip} if kind == "limited-slip" else {}
    cage = f"{name}.cage"

    def equations(v):
        laws, row = [inertia(a, v(J_p)), inertia(cage, v(J_c))], {a: 1, cage: -v(tau)}
        held = [] if mesh else [row]
        laws += [Law(row, lambda s: v(k) + v(c) * s)] if mesh else []
        if kind == "locked":
            return Equations(laws, [*held, twist(cage, b), twist(cage, other)])
        if kind == "limited-slip":
            laws.append(Law(twist(b, other), lambda s: v(slip) * s))
        return Equations(laws, [*held, {cage: 2, b: -1, other: -1}])

    return Component(entries, equations, a)


def belt(d: Draw, name: str, *nodes: str) -> Component:
    """Also a chain; the tensioner's arm turns a node of its own, with an inertia and a spring."""
    is_chain, count = d.sometimes(0.35), len(nodes)
    pitch = d.number(0.006, 0.02)
    if is_chain:
        teeth = [d.chance.randint(12, 60) * (-1 if i and d.sometimes(0.3) else 1) for i in range(count)]
        entries = {"type": "chain_drive", "sprockets": dict(zip(nodes, teeth, strict=True))}
    else:
        radii = [d.number(0.03, 0.2)] + [
            -d.plain(0.03, 0.2) if d.sometimes(0.3) else d.number(0.03, 0.2) for _ in nodes[1:]
        ]
        entries = {"type": "belt", "pulleys": dict(zip(nodes, radii, strict=True))}
    form = d.pick("rigid", "stiffness", "strain")
    k = [d.number(1e5, 1e7) for _ in nodes]
    EA, lengths, c = d.number(1e5, 1e6), [d.number(0.1, 0.6) for _ in nodes], d.c
    if form == "stiffness":
        entries["stiffness"] = k
    elif form == "strain":
        entries |= {"axial_stiffness": EA, "lengths": lengths}
    if form != "rigid":
        entries |= {"pitch": pitch} if is_chain else {}
        entries |= {"damping": c} if d.sometimes(0.5) else {}

    def equations(v):
        if is_chain:
            p = v(pitch) if form != "rigid" else v(1.0)
            r = [v(z) * p / (2 * pi()) for z in teeth]
        else:
            r = [v(one) for one in radii]
        ends = pairwise([*range(count), 0])
        rows = [combined((nodes[i], r[i] / r[0]), (nodes[j], -r[j] / r[0])) for i, j in ends]
        if form == "rigid":
            return Equations(held=rows[:-1])
        stiff = [v(one) if form == "stiffness" else v(EA) / v(L) for one, L in zip(k, lengths, strict=True)]
        damping = v(entries.get("damping", 0))
        return Equations(
            [Law(row, lambda s, x=x: x * r[0] ** 2 + damping * s) for row, x in zip(rows, stiff, strict=True)]
        )

    return Component(entries, equations, nodes[0])


Through = Callable[[Draw, str, str, str], Component]
THROUGH: Sequence[Through] = (plain_spring, plain_spring, rubber, gear, gear, clutch, gearbox, belt)
