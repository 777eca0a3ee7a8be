"""A small reader of Modelica models made of Modelica.Mechanics.Rotational components, for tests of what is written.

It knows nothing of the program that writes: declarations and connect equations are read from the text, every component
becomes the equations its source in the Modelica Standard Library 4.0 has (Components, Sensors and Sources), with angles
and cut torques of all flanges as unknowns, and everything is solved at a complex s by dense linear algebra.
"""

import math
import re

import numpy as np

DECLARATION = re.compile(
    r"(?P<kind>parameter Real|Modelica[\w.]+) (?P<name>\w+)(?P<mods>\((?:[^;\"]|\"[^\"]*\")*?\))?"
    r"(?: = (?P<value>[^\"]+?))?(?: \"(?:[^\"\\]|\\.)*\")?;"
)
FLANGES = {
    "Inertia": "flange_a flange_b",
    "Spring": "flange_a flange_b",
    "Damper": "flange_a flange_b",
    "SpringDamper": "flange_a flange_b",
    "IdealGear": "flange_a flange_b support",
    "IdealPlanetary": "sun carrier ring",
    "Fixed": "flange",
    "TorqueSensor": "flange_a flange_b",
    "Torque": "flange support",
    "Position": "flange support",
    "AngleSensor": "flange",
    "SpeedSensor": "flange",
    "AccSensor": "flange",
}


def split_top(text):
    """Parts between commas that are in no parentheses."""
    parts, depth = [""], 0
    for char in text:
        depth += (char == "(") - (char == ")")
        if char == "," and depth == 0:
            parts.append("")
        else:
            parts[-1] += char
    return [part.strip() for part in parts if part.strip()]


def equilibrated(matrix):
    """Factors of rows and columns that bring all entries near to one: torques are large, angles small."""
    rows, columns = np.ones(len(matrix)), np.ones(len(matrix[0]))
    for _ in range(30):
        size = np.abs(matrix) * rows[:, None] * columns
        rows /= np.sqrt(size.max(axis=1))
        columns /= np.sqrt((np.abs(matrix) * rows[:, None] * columns).max(axis=0))
    return rows, columns


class Model:
    def __init__(self, text, **changes):
        lines = [line.strip() for line in text.splitlines() if not line.strip().startswith("//")]
        cut = lines.index("equation")
        self.name = lines[0].split()[1]
        assert lines[-1] == f"end {self.name};"
        self.components, self.inputs, self.outputs, expressions = {}, [], [], {}
        for line in lines[1:cut]:
            match = DECLARATION.fullmatch(line)
            assert match, line
            kind, name = match["kind"], match["name"]
            assert name not in {**self.components, **expressions}, f"{name} is declared twice"
            mods = dict(part.split("=", 1) for part in split_top((match["mods"] or "()")[1:-1]))
            if kind == "parameter Real":
                expressions[name] = match["value"]
            elif kind.endswith(("RealInput", "RealOutput")):
                (self.inputs if kind.endswith("RealInput") else self.outputs).append(name)
            else:
                self.components[name] = (kind.split(".")[-1], mods)
        self.values = dict(changes)
        for _ in expressions:
            for name, expression in expressions.items():
                try:
                    self.values.setdefault(name, self.number(expression))
                except NameError:
                    continue
        self.connects, self.equations = [], []
        for line in lines[cut + 1 : -2]:
            joined = re.fullmatch(r"connect\(([\w.]+), ([\w.]+)\);", line)
            if joined:
                self.connects.append(joined.groups())
            else:
                self.equations.append(re.fullmatch(r"(\w+) = (.*);", line).groups())

    def number(self, expression):
        """A Modelica expression: integers of 32 bits, division of reals."""
        for digits in re.findall(r"(?<![\w.])\d+(?![\w.])", expression):
            assert int(digits) < 2**31, "an integer literal of Modelica has 32 bits"
        text = expression.replace("^", "**").replace("Modelica.Constants.pi", "pi")
        return float(eval(text, {"__builtins__": {}, "pi": math.pi, "sqrt": math.sqrt}, self.values))

    def flanges(self):
        for name, (kind, mods) in self.components.items():
            for flange in FLANGES[kind].split():
                if flange != "support" or mods.get("useSupport") == "true":
                    yield f"{name}.{flange}"

    def equations_at(self, s):
        """Matrix and right-hand sides (one column per input) over angles and torques of flanges and outputs."""
        unknowns = [f"{kind} {flange}" for flange in self.flanges() for kind in ("phi", "tau")] + self.outputs
        index = {name: at for at, name in enumerate(unknowns)}
        rows, right = [], []

        def add(terms, source=None, size=0.0):
            row = np.zeros(len(index), dtype=complex)
            for name, share in terms:
                row[index[name]] += share
            rows.append(row)
            drive = np.zeros(len(self.inputs), dtype=complex)
            if source is not None:
                drive[self.inputs.index(source)] = size
            right.append(drive)

        ends = (*self.inputs, *self.outputs)
        both = [pair for first, second in self.connects for pair in ((first, second), (second, first))]
        wires = {other: one for one, other in both if one in ends}
        signals = {}
        for name, (kind, mods) in self.components.items():
            phi = {flange: f"phi {name}.{flange}" for flange in FLANGES[kind].split()}
            tau = {flange: f"tau {name}.{flange}" for flange in FLANGES[kind].split()}
            value = {key: self.number(text) for key, text in mods.items() if text not in ("true", "false")}
            a, b = "flange_a", "flange_b"
            if kind == "Inertia":
                add([(phi[a], 1), (phi[b], -1)])
                add([(phi[a], value["J"] * s * s), (tau[a], -1), (tau[b], -1)])
            elif kind in ("Spring", "Damper", "SpringDamper"):
                law = value.get("c", 0) + value.get("d", 0) * s
                add([(phi[b], law), (phi[a], -law), (tau[b], -1)])
                add([(tau[a], 1), (tau[b], 1)])
            elif kind == "IdealGear":
                ratio, held = value["ratio"], mods.get("useSupport") == "true"
                support = [(phi["support"], ratio - 1)] if held else []
                add([(phi[a], 1), (phi[b], -ratio), *support])
                add([(tau[a], ratio), (tau[b], 1)])
                if held:
                    add([(tau["support"], 1), (tau[a], 1), (tau[b], 1)])
            elif kind == "IdealPlanetary":
                ratio = value["ratio"]
                add([(phi["carrier"], 1 + ratio), (phi["sun"], -1), (phi["ring"], -ratio)])
                add([(tau["ring"], 1), (tau["sun"], -ratio)])
                add([(tau["carrier"], 1), (tau["sun"], 1 + ratio)])
            elif kind == "Fixed":
                add([(phi["flange"], 1)])
            elif kind == "TorqueSensor":
                add([(phi[a], 1), (phi[b], -1)])
                add([(tau[a], 1), (tau[b], 1)])
                signals[f"{name}.tau"] = [(tau[a], 1)]
            elif kind == "Torque":
                add([(tau["flange"], 1)], wires[f"{name}.tau"], -1)
                if mods.get("useSupport") == "true":
                    add([(tau["support"], 1), (tau["flange"], 1)])
            elif kind == "Position":
                assert mods["exact"] == "true"
                held = mods.get("useSupport") == "true"
                add([(phi["flange"], 1), *([(phi["support"], -1)] if held else [])], wires[f"{name}.phi_ref"], 1)
                if held:
                    add([(tau["support"], 1), (tau["flange"], 1)])
            else:
                add([(tau["flange"], 1)])
                signal, power = {"AngleSensor": ("phi", 0), "SpeedSensor": ("w", 1), "AccSensor": ("a", 2)}[kind]
                signals[f"{name}.{signal}"] = [(phi["flange"], s**power)]
        for signal, output in wires.items():
            if output in self.outputs:
                add([(output, 1), *((name, -share) for name, share in signals[signal])])
        for output, text in self.equations:
            terms = [part.split("*") for part in text.split(" + ")]
            add([(output, 1)] + [(n, -float(f) * share) for f, signal in terms for n, share in signals[signal]])
        for flanges in self.connection_sets():
            for other in flanges[1:]:
                add([(f"phi {flanges[0]}", 1), (f"phi {other}", -1)])
            add([(f"tau {flange}", 1) for flange in flanges])
        return np.array(rows), np.array(right), index

    def connection_sets(self):
        sets = {flange: {flange} for flange in self.flanges()}
        for first, second in self.connects:
            if first in sets and second in sets:
                union = sets[first] | sets[second]
                for flange in union:
                    sets[flange] = union
        order = list(sets)
        return [sorted(group, key=order.index) for group in {id(group): group for group in sets.values()}.values()]

    def responses(self, s):
        """Outputs over inputs at s, shape (n_out, n_in)."""
        matrix, right, index = self.equations_at(s)
        rows, columns = equilibrated(matrix)
        scaled = matrix * rows[:, None] * columns
        right = right * rows[:, None]
        solution = np.linalg.solve(scaled, right)
        for _ in range(3):  # refined with the residual in extended precision
            residual = right - np.asarray(scaled, dtype=np.clongdouble) @ solution
            solution = solution + np.linalg.solve(scaled, np.asarray(residual, dtype=complex))
        solution = solution * columns[:, None]
        return np.array([solution[index[name]] for name in self.outputs])

    def eigenvalues(self):
        """All finite s at which the equations without inputs have a solution."""
        from scipy.linalg import eig

        samples = {s: self.equations_at(s)[0] for s in (0.0, 1.0, -1.0)}
        zero = samples[0.0]
        second = (samples[1.0] + samples[-1.0]) / 2 - zero
        first = (samples[1.0] - samples[-1.0]) / 2
        one, none = np.eye(len(zero)), np.zeros_like(zero)
        eigenvalues = eig(
            np.block([[none, one], [-zero, -first]]), np.block([[one, none], [none, second]]), right=False
        )
        return eigenvalues[np.isfinite(eigenvalues) & (np.abs(eigenvalues) < 1e9)]
