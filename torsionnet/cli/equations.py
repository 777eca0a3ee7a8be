"""Equations of motion in symbols, and their matrices in numbers."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from torsionnet.response.table import Column, Table

if TYPE_CHECKING:
    from torsionnet.drivetrain import Drivetrain

MATRICES = (
    ("M", "kg*m^2", "Inertia matrix"),
    ("C", "N*m*s/rad", "Damping matrix"),
    ("K", "N*m/rad", "Stiffness matrix"),
)
WIDTH = 100


def equations_text(rig: Drivetrain) -> str:
    """An equation for each coordinate, the other nodes in terms of these, and what was taken to be zero."""
    system = rig.symbolic()
    lines = [f"{rig.title}: equations of motion (' is d/dt)"]
    for name, equation in zip(system.coordinates, system.equations(), strict=True):
        lines += [f"{name}:", *_folded(equation)]
    others = [f"theta_{node} = {text}" for node, text in _dependent(system).items()]
    lines += ["where", *(f"    {text}" for text in others)] if others else []
    if system.conditions:
        lines += ["taking the values into account:", *(f"    {condition} = 0" for condition in system.conditions)]
    return "\n".join(lines)


def _folded(equation: str) -> list[str]:
    """Lines of whole terms."""
    lines = [" " * 4]
    for term in _terms(equation):
        if len(lines[-1]) + len(term) >= WIDTH:
            lines.append(" " * 8)
        lines[-1] += term if lines[-1].isspace() else f" {term}"
    return lines


def _terms(equation: str) -> list[str]:
    """The text apart before every +, - and = outside parentheses."""
    terms: list[str] = []
    depth = 0
    for word in equation.split(" "):
        if not terms or (depth == 0 and word in ("+", "-", "=")):
            terms.append(word)
        else:
            terms[-1] += f" {word}"
        depth += word.count("(") - word.count(")")
    return terms


def _dependent(system: Any) -> dict[str, str]:
    """Angles of the nodes that are no coordinates."""
    found = {}
    for row, node in enumerate(system.nodes):
        if node not in system.coordinates:
            terms = [
                _product(system.T[row, column], name)
                for column, name in enumerate(system.coordinates)
                if system.T[row, column] != 0
            ]
            found[node] = " + ".join(terms) or "0"
    return found


def _product(coefficient: Any, name: str) -> str:
    if coefficient == 1:
        return f"theta_{name}"
    return f"{coefficient} theta_{name}" if coefficient.is_Symbol else f"({coefficient}) theta_{name}"


def matrix_tables(rig: Drivetrain) -> list[Table]:
    """M, C, K with named rows and columns."""
    coordinates = rig.assembly.kinematics.coordinates
    columns = (Column(""), *(Column(name) for name in coordinates))
    notes = ("frequency-dependent stiffness is not included",) if rig.assembly.system.dynamic else ()
    return [
        Table(
            f"{rig.title}: {title} {symbol} [{unit}]",
            columns,
            tuple((name, *row) for name, row in zip(coordinates, _rows(rig, symbol), strict=True)),
            notes,
        )
        for symbol, unit, title in MATRICES
    ]


def _rows(rig: Drivetrain, symbol: str) -> list[list[float]]:
    rows: list[list[float]] = getattr(rig.assembly.system, symbol).tolist()
    return rows


def equations_data(rig: Drivetrain) -> dict[str, Any]:
    system = rig.symbolic()
    symbolic = {symbol: [[str(cell) for cell in row] for row in getattr(system, symbol).tolist()] for symbol in "MCK"}
    return {
        "coordinates": list(system.coordinates),
        "equations": list(system.equations()),
        "dependent": _dependent(system),
        "conditions": [str(condition) for condition in system.conditions],
        **symbolic,
    }


def matrices_data(rig: Drivetrain) -> dict[str, Any]:
    coordinates = list(rig.assembly.kinematics.coordinates)
    return {"coordinates": coordinates, **{symbol: _rows(rig, symbol) for symbol in "MCK"}}
