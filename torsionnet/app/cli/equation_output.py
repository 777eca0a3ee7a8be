"""Equations of motion, matrices and transfer functions as plain data, for JSON."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, Any

from torsionnet.base.result_rows import Out

if TYPE_CHECKING:
    from torsionnet.drivetrain import Drivetrain
    from torsionnet.symbolic.simplified import Simplified


@dataclass(frozen=True)
class Configured:
    """Name of the configuration that a record is of; empty for the model as written."""

    configuration: str


@dataclass(frozen=True)
class EquationsOfMotion:
    """Equations of motion of a drivetrain as texts; the matrices by rows."""

    coordinates: tuple[str, ...]
    equations: tuple[str, ...]
    dependent: Mapping[str, str]
    conditions: tuple[str, ...]
    inertia: Annotated[list[list[str]], Out(json="M")]
    damping: Annotated[list[list[str]], Out(json="C")]
    stiffness: Annotated[list[list[str]], Out(json="K")]


@dataclass(frozen=True)
class ConfiguredMotion(EquationsOfMotion, Configured):
    """Equations of motion of one configuration, as ``torsionnet equations --json`` prints them."""


@dataclass(frozen=True)
class SimplificationErrors:
    """Largest relative errors of frequencies and damping ratios, and of magnitudes (dB), of a simplified drivetrain."""

    omega: float
    zeta: float
    decibels: float


@dataclass(frozen=True)
class TransferFunctionRecord:
    """Transfer function as text, as ``torsionnet equations --tf --json`` prints it, and what was left out of it."""

    configuration: str
    transfer_function: str
    text: str
    left_out: Annotated[tuple[str, ...] | None, Out(optional=True)] = None
    band: Annotated[tuple[float, float] | None, Out(optional=True)] = None
    errors: Annotated[SimplificationErrors | None, Out(optional=True)] = None


@dataclass(frozen=True)
class MatricesRecord:
    """Matrices M, C and K of a drivetrain in numbers by rows, in SI units."""

    coordinates: tuple[str, ...]
    inertia: Annotated[list[list[float]], Out(json="M")]
    damping: Annotated[list[list[float]], Out(json="C")]
    stiffness: Annotated[list[list[float]], Out(json="K")]


def simplification_errors(short: Simplified) -> SimplificationErrors:
    """Errors of a simplified drivetrain as plain data, relative ones and those of magnitudes in decibels."""
    errors = short.errors
    return SimplificationErrors(errors.omega, errors.zeta, errors.decibels)


def equations_of_motion(rig: Drivetrain) -> EquationsOfMotion:
    """Record with the equations of motion of a drivetrain as texts."""
    system = rig.symbolic()
    matrices = ([[str(cell) for cell in row] for row in getattr(system, symbol).tolist()] for symbol in "MCK")
    return EquationsOfMotion(
        system.coordinates,
        (*system.equations(), *system.laws()),
        dependent_angles(system),
        tuple(map(str, system.conditions)),
        *matrices,
    )


def matrices_record(rig: Drivetrain) -> MatricesRecord:
    """Matrices M, C and K of a drivetrain in numbers by rows, in SI units."""
    return MatricesRecord(rig.assembly.kinematics.coordinates, *(matrix_rows(rig, symbol) for symbol in "MCK"))


def dependent_angles(system: Any) -> dict[str, str]:
    """Angles of the nodes that are no coordinates, as text in terms of the coordinates, by node."""
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


def matrix_rows(rig: Drivetrain, symbol: str) -> list[list[float]]:
    """Rows of numbers in SI units of the drivetrain's matrix M, C or K, shape (n_coordinates, n_coordinates)."""
    rows: list[list[float]] = getattr(rig.assembly.system, symbol).tolist()
    return rows


def _product(coefficient: Any, name: str) -> str:
    if coefficient == 1:
        return f"theta_{name}"
    return f"{coefficient} theta_{name}" if coefficient.is_Symbol else f"({coefficient}) theta_{name}"
