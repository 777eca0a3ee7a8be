"""Controlled torques, out of the page on elements."""

from __future__ import annotations

from flint import acb

from plain.component import Component, Draw, Equations, Law, twist

DEGREE = {"angle": 0, "velocity": 1, "acceleration": 2}


def controller(d: Draw, name: str, *nodes: str) -> Component:
    a, b, e = nodes
    sense, act = d.pick(a, [a, b], [b, e]), d.pick(a, b, [a, b], [e, b])
    quantity, tau = d.pick("angle", "velocity", "velocity", "acceleration"), d.number(0.002, 0.05)
    scale = {"angle": 300.0, "velocity": 10.0, "acceleration": 0.02}[quantity]
    p, i, dd = (d.number(x * scale, 10 * x * scale) for x in (0.1, 1, 0.005))
    filtering, gain, x0, x1 = d.number(0.005, 0.05), -d.plain(0.1 * scale, scale), d.number(5, 50), d.number(60, 300)
    form = d.pick("gain", "pid", "tf", "zpk", "ss")
    entries = {"type": "controller", "sense": {quantity: sense}, "act": act}
    entries["law"] = {
        "gain": gain,
        "pid": {"p": f"-{p}", "i": f"-{i}", "d": f"-{dd}", "filter": filtering},
        "tf": {"numerator": [gain, x0], "denominator": [1, x1, 400]},
        "zpk": {"gain": gain, "zeros": [f"-{x0}"], "poles": [f"-{x1}", [-30.0, 40.0]]},
        "ss": {"A": [[f"-{x1}", 1], [-3, f"-{x0}"]], "B": [[1], [0]], "C": [[gain, 0]], "D": [[gain]]},
    }[form]
    delayed = d.sometimes(0.3)
    entries |= {"delay": tau} if delayed else {}

    def law(v, s):
        if form == "gain":
            return acb(gain)
        if form == "pid":
            return -v(p) - v(i) / s - v(dd) * s / (1 + v(filtering) * s)
        if form == "tf":
            return (gain * s + v(x0)) / (s * s + v(x1) * s + 400)
        if form == "zpk":
            return gain * (s + v(x0)) / ((s + v(x1)) * ((s + 30) ** 2 + 1600))
        return gain * (s + v(x0)) / ((s + v(x1)) * (s + v(x0)) + 3) + gain

    def roots(v):
        if form == "pid":
            return [acb(0), -1 / v(filtering)]
        if form == "tf":
            half = v(x1) / 2
            return [-half + sign * (half * half - 400).sqrt() for sign in (1, -1)]
        if form == "zpk":
            return [-v(x1), acb(-30, 40), acb(-30, -40)]
        if form == "ss":
            half, gap = (v(x1) + v(x0)) / 2, (v(x1) - v(x0)) / 2
            return [-half + sign * (gap * gap - 3).sqrt() for sign in (1, -1)]
        return []

    def row(of):
        return {of: 1} if isinstance(of, str) else twist(*of)

    def equations(v):
        def kappa(s):
            wait = (-s * v(tau)).exp() if delayed else 1
            return -law(v, s) * wait * s ** DEGREE[quantity]

        return Equations([Law(row(act), kappa, row(sense))])

    return Component(entries, equations, act if isinstance(act, str) else act[0], -1, not delayed, roots)
