"""Derivatives of poles with respect to parameters, from the responses around the poles.

Around a pole a response Y(s) of some probes to themselves is c r l c^T / (s - lambda) and something smooth, and its
derivatives, which follow from twists as everywhere, are

    dY/dp = c r l c^T dlambda/dp / (s - lambda)^2 + ...,    dY/ds = -c r l c^T / (s - lambda)^2 + ...

Means over a circle around the pole leave these parts alone, and their quotient is the derivative of the pole, for
complex modes of any damping. Of a repeated pole the derivatives are the eigenvalues of the pencil of both matrices: it
parts in the directions that the parameter chooses. Against a measured input the response is the one with the drive that
keeps the reading at zero.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import scipy

from torsionnet.base.errors import UsageError
from torsionnet.linear.assembly.assembled import AssembledModel
from torsionnet.linear.assembly.law_stiffness import LawStiffness
from torsionnet.linear.assembly.rows import ComplexArray, FloatArray
from torsionnet.linear.dynamic_stiffness.quotient import respond
from torsionnet.linear.dynamic_stiffness.transfer_request import TransferRequest, cut_definition, elements_beyond_cut
from torsionnet.linear.sensitivity.augmented import Augmented, augmented
from torsionnet.linear.sensitivity.derivative_problem import DerivativeProblem
from torsionnet.linear.sensitivity.unknowns import Unknowns
from torsionnet.model.channels import Input, Sensor

CIRCLE_RADIUS, CIRCLE_RADIUS_MEASURED = 1e-6, 1e-4
"""Radius of the circle around a pole on which responses are taken, over the distance to the next pole, larger against a
measured input.

Next to a pole small twists stand out best; what is left of a difference, as against a measured input, does farther off.
"""
MEASURED_PROBES = 6
"""Number of further nodes tried as probes against a measured input, as more find the pole more surely, at more cost."""
AXIS_ROUNDING = 1e-9
"""Share of a pole's derivative below which its real or imaginary part is rounding where only the other part can be."""
DEFECTIVE_SHARE = 0.7
"""Share of a response growing quicker than 1/x near equal poles, above which they have too few mode shapes."""


def clearance(poles: ComplexArray, group: Sequence[int]) -> float:
    """Distance in rad/s of a group of equal poles from all other poles, conjugates and zero included."""
    # Poles are listed with Im >= 0: their conjugates and the zero of rigid bodies are neighbours too.
    others = np.concatenate([np.delete(poles, group), poles.conj()[poles.imag > 0], [0.0]])
    return float(np.abs(others - np.mean(poles[group])).min())


class ResponsesAroundPoles:
    """Responses at probe nodes around the poles of a drivetrain, from which the derivatives of the poles follow."""

    def __init__(
        self, drivetrain: AssembledModel, chosen: Unknowns, sensors: Sequence[Sensor], loads: Sequence[Input]
    ) -> None:
        self.chosen: Unknowns = chosen
        self.nodes: tuple[str, ...] = drivetrain.assembly.kinematics.nodes
        redundant = drivetrain.assembly.kinematics.reduction.redundant
        self.system: Augmented = augmented(chosen, chosen.start, self.nodes, redundant)
        self.channels: dict[Input, str] = {channel: name for name, channel in drivetrain.inputs.items()}
        self.sensors: Sequence[Sensor] = sensors
        self.loads: Sequence[Input] = loads
        self.known: dict[tuple[str, ...], DerivativeProblem] = {}

    @classmethod
    def of(cls, drivetrain: AssembledModel, chosen: Unknowns, request: TransferRequest | None) -> ResponsesAroundPoles:
        """Responses around the poles of a drivetrain, or around its poles against the measured input of a request.

        A measured torque may cut the drivetrain.
        """
        if request is None:
            return cls(drivetrain, chosen, (), ())
        kept = elements_beyond_cut(drivetrain, request)
        if kept is None:
            # A reading referred to another shaft is scaled, which moves no pole.
            sensors = [replace(sensor, referred_to=None) for sensor in request.sensors]
            return cls(drivetrain, chosen, sensors, request.excitations[:1])
        chosen = replace(chosen, definition=cut_definition(chosen.definition, kept))
        return cls(drivetrain.with_definition(chosen.definition), chosen, (), ())

    def slopes(self, poles: ComplexArray, shapes: ComplexArray, clearance: float) -> ComplexArray:
        """Derivatives (multiplicity, n_p) in rad/s per SI unit of equal poles with shapes (n_nodes, multiplicity)."""
        count, center = len(poles), complex(np.mean(poles))
        near = CIRCLE_RADIUS_MEASURED if self.sensors else CIRCLE_RADIUS
        # Near to the pole against its neighbours, and far off against what rounding parts equal poles by.
        apart = max(near * clearance, 3 * np.abs(poles - center).max()) * _circle(2 * count + 2)
        nothing = np.full((count, len(self.chosen.names)), complex(np.nan, np.nan))
        if count > len(shapes):
            return nothing
        # Tables are read at the pole's own |Im lambda| on the whole circle.
        at = np.full(len(apart), abs(center.imag))
        responses = self._responses(self._probes(shapes), center + apart, at)
        # The mean of (s - lambda) Y over the circle is the residue c r l c^T.
        first = np.einsum("f,fzx->zx", apart, responses.values) / len(apart)
        sizes = responses.sizes.sum(axis=0)
        places = np.ix_(*_pivots(first, np.abs(first) / np.where(sizes > 0, sizes, 1.0), count))
        whole = responses.values.transpose(1, 2, 0)[places]
        # What grows quicker than residue / (s - lambda) is a pole with too few shapes, which has no derivative.
        if count > 1 and np.abs(whole - first[places][..., None] / apart).max() > DEFECTIVE_SHARE * np.abs(whole).max():
            return nothing
        # The mean of (s - lambda)^2 dY/dp is residue times dlambda/dp, that of dY/ds is minus the residue.
        moving = np.einsum("f,fzxp->zxp", apart**2, responses.slopes)[places]
        moved, rate, followed = moving[..., :-2], -moving[..., -2], moving[..., -1]
        if count == 1:
            # Tables follow the pole, dlambda = direct + through d Im lambda, which is solved for d Im lambda.
            direct, through = moved[0] / rate[0, 0], followed[0, 0] / rate[0, 0]
            return _on_axes(np.asarray(direct + through * direct.imag / (1 - through.imag)), center)
        if self.system.tables:
            owners = ", ".join(dict.fromkeys(self.system.law_owners[law] for law, _ in self.system.tables))
            raise UsageError(
                "modes with equal frequencies have no sensitivities with springs tabulated "
                f"over frequency ({owners}); give these a constant stiffness",
                kind="unsupported-law",
            )
        # Repeated: eigenvalues of the pencil of both matrices.
        parted = [scipy.linalg.eigvals(moved[..., p], rate).astype(complex) for p in range(moved.shape[2])]
        return np.stack([np.sort_complex(_on_axes(slopes, center)) for slopes in parted], axis=1)

    def _probes(self, shapes: ComplexArray) -> DerivativeProblem:
        """Response problem with probes, that is loads and readings at nodes which move in the mode shapes.

        Few different ones serve all modes.

        The motion that answers a drive which keeps a reading at zero is another one than that which it drives, so that
        some more nodes are tried there.
        """
        size, count = dict(zip(self.nodes, np.abs(shapes[:, 0]), strict=True)), shapes.shape[1]
        used = [nodes for nodes in self.known if count == 1 and size[nodes[0]] >= max(size.values()) / 2]
        if used:
            return self.known[used[0]]
        # Pivoted QR takes the nodes at which the shapes of equal poles are most independent.
        places: list[int] = scipy.linalg.qr(shapes.T, pivoting=True, mode="r")[1][:count].tolist()
        if self.sensors:
            places += np.linspace(0, len(self.nodes) - 1, MEASURED_PROBES).round().astype(int).tolist()
        nodes = tuple(dict.fromkeys(self.nodes[place] for place in places))
        if nodes not in self.known:
            values, elements = self.chosen.values(self.chosen.start), dict(self.chosen.definition.elements)
            self.known[nodes] = DerivativeProblem(
                self.system, self.sensors, elements, values, self.loads, self.channels, self.nodes, nodes
            )
        return self.known[nodes]

    def _responses(self, probes: DerivativeProblem, s: ComplexArray, at: FloatArray) -> Responses:
        """Responses (n_points, n, n) of probes at s, with derivatives to parameters, to s and to table frequency.

        A measured input is given, and its drive read.
        """
        # s is off the imaginary axis: kappa(s) with c s and J s^2 is handed over as samples.
        kappa = self.system.kappa(s, at)
        nothing = np.zeros((1, len(kappa)))
        laws = LawStiffness(nothing, nothing, nothing, np.zeros(len(s))).with_sampled_stiffness(kappa)
        solved = respond(probes.problem, laws)
        y, rates = probes.values(solved, s), self.system.kappa_rates(s, at)
        parts = [probes.slopes(solved, self.system, kappa, s, at)]
        parts += [probes.slopes_along(solved, rate, s)[..., None] for rate in rates]
        responses = Responses(y, np.abs(y), np.concatenate(parts, axis=3))
        return responses.with_imposed_reading() if self.sensors else responses


def _on_axes(slopes: ComplexArray, pole: complex) -> ComplexArray:
    """Derivatives of an undamped pole (rad/s per SI unit) without rounding beside the real or imaginary axis."""
    if pole.real:
        return slopes
    least = AXIS_ROUNDING * np.abs(slopes)
    real, imag = (np.where(np.abs(part) > least, part, 0.0) for part in (slopes.real, slopes.imag))
    return np.asarray(real + 1j * imag, dtype=complex)


def _circle(count: int) -> ComplexArray:
    """Points (count,) on the unit circle of the complex plane, evenly spaced."""
    return np.asarray(np.exp(2j * np.pi * (np.arange(count) + 0.5) / count))


@dataclass(frozen=True)
class Responses:
    """Responses (n_points, n, n) of probes to loads, sizes of their terms, and derivatives to parameters and s.

    The derivatives are (n_points, n, n, n_p + 2).
    """

    values: ComplexArray
    sizes: FloatArray
    slopes: ComplexArray

    def with_imposed_reading(self) -> Responses:
        """Responses (n_points, n, n) with the first reading imposed and the torque for it read in place of it.

        With mu = y_00, u = (given - y_0l f_l) / mu, and every other reading is y_c0 u + y_cl f_l.
        """
        # y = [[mu, y_0l], [y_c0, y_cl]], mu the reading under its own drive
        y, identity = self.values, np.eye(self.values.shape[1])[1:, 1:]
        rate = 1 / y[:, :1, :1]
        through, drive = y[:, 1:, :1] * rate, y[:, :1, 1:] * rate
        # Derivatives as left dY right, with d(1 / mu) = -dmu / mu^2 in the first place.
        left, right = np.zeros_like(y), np.zeros_like(y)
        left[:, :1, :1], left[:, 1:, :1], left[:, 1:, 1:] = -rate, -through, identity
        right[:, :1, :1], right[:, :1, 1:], right[:, 1:, 1:] = rate, -drive, identity
        values, sizes = -left, np.abs(left)
        values[:, :1], values[:, 1:, :1] = right[:, :1], through
        values[:, 1:, 1:] = y[:, 1:, 1:] - y[:, 1:, :1] * drive
        sizes[:, :1] = np.abs(right[:, :1])
        sizes[:, 1:, 1:] = np.abs(y[:, 1:, 1:]) + np.abs(y[:, 1:, :1] * drive)
        return Responses(values, sizes, np.einsum("fij,fjkq,fkl->filq", left, self.slopes, right))


def _pivots(residues: ComplexArray, shares: FloatArray, count: int) -> tuple[list[int], list[int]]:
    """Indices of the rows and columns of the ``count`` largest pivots of residues, where the pole counts most."""
    # Entries with far less of the residue in them than the best are other modes or rounding.
    left = np.where(shares > shares.max() / 10, residues, 0.0)
    # Rows and columns are brought to one size, as readings and loads have different units.
    for axis in (0, 1):
        largest = np.abs(left).max(axis=axis, keepdims=True)
        left = left / np.where(largest > 0, largest, 1.0)
    rows, columns = list[int](), list[int]()
    for _ in range(count):
        row, column = np.unravel_index(np.argmax(np.abs(left)), left.shape)
        rows.append(int(row))
        columns.append(int(column))
        # Schur complement of the pivot.
        if left[row, column]:
            left = left - np.outer(left[:, column], left[row]) / left[row, column]
    return rows, columns
