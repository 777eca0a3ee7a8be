"""Plant condensed to the twists of its laws of motion: exact receptances at every harmonic of a periodic motion.

The plant without its laws answers at s = j k w with its dynamic stiffness D(s), in which springs, dampers, loss
factors, tables, controllers and delays stand as they are. Beside each law over the twist stands a spring k_0, which its
torque takes away again,

    D_0(s) = D(s) + B^T diag(k_0) B,   D_0 q = F u - B^T tau,   tau = T(gamma, gamma') - k_0 gamma,   gamma = B q,

so that D_0(0) holds the mean twists. What turns freely as a whole twists nothing: it is left out of the mean, and the
mean torques on it have to balance.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from torsionnet.base.errors import SolveError, UsageError
from torsionnet.base.phrases import phrase
from torsionnet.linear.assembly.assembled import AssembledModel
from torsionnet.linear.assembly.law_stiffness import Functional
from torsionnet.linear.assembly.rows import ComplexArray, FloatArray
from torsionnet.model.channels import Input
from torsionnet.model.elements import MotionLaw
from torsionnet.model.motion_laws.describing_functions import has_steps
from torsionnet.model.motion_laws.piece_curve import PieceCurve, Slope
from torsionnet.model.motion_laws.smooth_curves import CubicCurve
from torsionnet.motion.motion_plant import PlacedLaw, motion_plant, placed_plant
from torsionnet.motion.smooth_laws import SplitPlant, float_laws, split_plant

FREE = 1e-11
"""Singular value of the stiffness at rest, over the largest, below which a motion turns freely."""
BALANCED = 1e-9
"""Share of the mean torques that may be left over by rounding on what turns freely."""
FAR = 1e4
"""Frequencies, over the highest of interest, at which a spring before friction shows: inertias have faded there."""

MOST_KEPT = 8
"""Most sets of receptances that are kept: a way at one frequency asks for the same ones again and again."""


@dataclass(frozen=True, eq=False)
class CondensedLaw:
    """Law of motion among the unknowns: its element, its curve with floats, and its row over the coordinates.

    ``number`` is that of the placed law in the assembly, ``reference`` the spring k_0 in N m/rad beside it.
    """

    owner: str
    law: MotionLaw
    number: int
    row: FloatArray
    reference: float


@dataclass(frozen=True, eq=False)
class Receptances:
    """Motions of the coordinates at the harmonics of one frequency.

    Attributes
    ----------
    s : (n,) complex array
        j k w in rad/s of each harmonic.
    driven : (n, n_q, n_in) complex array
        Coordinates in rad per N m of each input.
    own : (n, n_q, n_laws) complex array
        Coordinates in rad per N m of torque between the ends of each law, in the sense of its row.
    """

    s: ComplexArray
    driven: ComplexArray
    own: ComplexArray


class CondensedPlant:
    """Linear plant around laws of motion under torques on inputs, see the text of the module."""

    def __init__(self, drivetrain: AssembledModel, inputs: Sequence[Input], reference: str = "") -> None:
        self.drivetrain, self.reference = drivetrain, reference
        self.placed = placed_plant(drivetrain)
        self.assembly = self.placed.assembly
        self.inputs = tuple(inputs)
        self._known: dict[tuple[float, range], Receptances] = {}
        floats = float_laws(drivetrain, self.placed)
        self.laws = tuple(
            CondensedLaw(law.owner, floats[law.number], law.number, law.row, _reference(floats[law.number]))
            for law in self.placed.laws
        )
        self._require_own_motion()
        n_q = self.assembly.system.n_coordinates
        self.rows = np.array([law.row for law in self.laws]).reshape(len(self.laws), n_q)
        self.references = np.array([law.reference for law in self.laws])
        self.driven = self.assembly.rows_of({reference: 1})[0] if reference else np.zeros(n_q)
        self.columns = np.array([self.assembly.rows_of(channel.row)[0] for channel in inputs]).reshape(-1, n_q).T

    @cached_property
    def in_time(self) -> SplitPlant:
        """Plant with states over time, its laws of straight pieces apart from smooth ones.

        Raises
        ------
        UsageError
            A delay, or a law that depends on frequency, has no states.
        """
        for element in self.drivetrain.definition.switched_on:
            if element.over_time is not element:
                text = f"{element.name} remembers where it turned back, which no state of periodic motion holds"
                raise UsageError(text, kind="unsupported-law")
        return split_plant(self.drivetrain, motion_plant(self.drivetrain))

    @cached_property
    def has_states(self) -> bool:
        """Whether the plant has states over time: nothing in it has a delay or depends on frequency."""
        try:
            return self.in_time is not None
        except UsageError:
            return False

    def _require_own_motion(self) -> None:
        for law in self.laws:
            if law.law.sensed or law.law.lag:
                why = (
                    "follows the speed of another part" if law.law.sensed else "follows its curve with a time constant"
                )
                text = f"{law.owner}: its torque {why}, which periodic motion does not work out; use simulate"
                raise UsageError(text, kind="unsupported-law")

    def stiffness(self, s: ComplexArray) -> ComplexArray:
        """Dynamic stiffness D_0 (n, n_q, n_q) in N m/rad at the Laplace variable s (n,) in rad/s."""
        system = self.placed.linear
        rows, omega = system.rows, s.imag
        # D = sum kappa b b^T with kappa = J s^2 + c s + k; actions drive, and so are taken off.
        kappa = system.inertia * s[:, None] ** 2 + system.damping * s[:, None] + system.stiffness
        kappa = kappa.astype(complex)
        for number, law in self.assembly.system.dynamic:
            kappa[:, number] += np.asarray(law.kappa(omega))
        D = rows.T @ (kappa[:, :, None] * rows)
        for action in self.assembly.system.actions:
            driven, sensed = (self.assembly.over_coordinates(row) for row in (action.row, action.sensed))
            D -= action.kappa(s)[:, None, None] * np.outer(driven, sensed)
        if not np.isfinite(D).all():
            raise UsageError(
                "a controller with an integrator holds no mean motion; periodic motion needs a gain at rest",
                kind="unsupported-law",
            )
        return np.asarray(D + self.rows.T @ (self.references[:, None] * self.rows))

    def receptances(self, omega: float, harmonics: range) -> Receptances:
        """Receptances at harmonics of omega in rad/s, of which 0 is the mean; those asked for last are kept."""
        key = float(omega), harmonics
        if key not in self._known:
            if len(self._known) >= MOST_KEPT:
                del self._known[next(iter(self._known))]
            self._known[key] = self._receptances(np.asarray(1j * omega * np.array(harmonics), dtype=np.complex128))
        return self._known[key]

    def _receptances(self, s: ComplexArray) -> Receptances:
        loads = np.hstack([self.columns, self.rows.T])
        D = self.stiffness(s)
        answers = np.zeros((len(s), *loads.shape), dtype=complex)
        still = s == 0
        if (~still).any():
            every_load = np.broadcast_to(loads, (int((~still).sum()), *loads.shape))
            try:
                answers[~still] = np.linalg.solve(D[~still], every_load)
            except np.linalg.LinAlgError:
                raise SolveError(
                    f"the plant resonates without damping at {s[~still].imag.min() / (2 * np.pi):.6g} Hz or a multiple "
                    "of it; ask for a frequency beside it, or give it damping",
                    kind="no-solution",
                ) from None
        if still.any() and self.turning.any():
            # the drive gives what is left over on what turns freely
            (turns,) = self.free.T
            loads = loads - np.outer(self.driven, turns @ loads) / (turns @ self.driven)
        for place in np.flatnonzero(still):
            answers[place] = _held(D[place].real) @ loads
        n_in = self.columns.shape[1]
        return Receptances(s, answers[:, :, :n_in], answers[:, :, n_in:])

    @cached_property
    def free(self) -> FloatArray:
        """Motions (n_q, n) that turn freely as a whole."""
        scaled, scale = _scaled(self.stiffness(np.zeros(1, dtype=complex))[0].real)
        left, sizes, _ = np.linalg.svd(scaled)
        return np.asarray(left[:, sizes <= FREE * sizes.max(initial=0.0)] * scale[:, None])

    @cached_property
    def turning(self) -> FloatArray:
        """Mean rates (n_laws,) of laws over the speed of the reference node, as parts of what turns freely with it.

        Only of laws without steps, whose mean torques the drive at that node balances at each speed.
        """
        if self.free.shape[1] != 1 or abs(share := float(self.driven @ self.free[:, 0])) < FREE:
            return np.zeros(len(self.laws))
        follows = [law.law.curve.over == "rate" and not has_steps(law.law.curve) for law in self.laws]
        rates = self.rows @ self.free[:, 0] / share
        return np.where(follows & (np.abs(rates) > FREE), rates, 0.0)

    def require_balance(self, means: FloatArray) -> None:
        """Require that mean torques (n_in,) in N m balance on what turns freely.

        Where laws turn with it the drive balances them.

        Raises
        ------
        UsageError
            A torque is left over.
        """
        free = self.free
        torques = self.columns @ means
        # Power of the torques on each free motion; nothing may be left of it.
        over = free.T @ torques
        if not self.turning.any() and (np.abs(over) > BALANCED * (np.abs(free.T) @ np.abs(torques))).any():
            worst = int(np.abs(over).argmax())
            rest = float(over[worst] / np.abs(free[:, worst]).max())
            text = "the mean torques do not balance on what turns freely: {rest:.6g} N m are left; give the load"
            raise UsageError(phrase(text, rest=rest), kind="unbalanced-torques")
        # A law with a share in what turns freely has no mean twist of its own.
        turned = [
            law
            for law, row, rate in zip(self.laws, self.rows @ free, self.turning, strict=True)
            if np.abs(row).max(initial=0.0) > FREE and not rate
        ]
        if turned:
            names, loads = (
                ", ".join(law.owner for law in turned),
                [law for law in turned if not has_steps(law.law.curve)],
            )
            text = "friction alone holds the mean twist here; give a spring beside it"
            if loads:
                text = "its torque follows the mean speed of what turns freely, which has no place over frequency"
                text += "; ask over speed, or give its mean torque and its damping at the speed instead"
            raise UsageError(f"{names}: {text}", kind="unsupported-law" if loads else "indeterminate-motion")

    def spring_before(self, law: int, highest: float) -> float:
        """Stiffness in N m/rad of the spring through which a law moves what has no inertia, else 0.

        ``highest`` in rad/s is the highest frequency of interest. Far above it the receptance of a massless end is
        that of its spring.
        """
        first, second = (
            complex(self.rows[law] @ driven[:, law]) for driven in self.receptances(highest * FAR, range(1, 3)).own
        )
        # A spring's receptance stays; that of an inertia falls to a quarter, that of a damper to a half.
        return 1 / first.real if abs(second - first) < 1e-3 * abs(first) else 0.0

    def reading(self, reading: Functional, receptances: Receptances) -> tuple[ComplexArray, ComplexArray, ComplexArray]:
        """Harmonics of a sensor over coordinates (n, n_q), torques of laws (n_laws,) and torques of inputs (n_in,)."""
        over_q = np.zeros((len(receptances.s), self.rows.shape[1]), dtype=complex)
        over_laws = np.zeros(len(self.laws), dtype=complex)
        places = {law.number: place for place, law in enumerate(self.laws)}
        system = self.assembly.system
        dynamic = dict(system.dynamic)
        for term in reading.terms:
            if term.law in places:
                over_laws[places[term.law]] += float(term.factor)
                continue
            # A torque reads kappa gamma = (J s^2 + c s + k) gamma of its law, a motion s^power gamma.
            kappa = receptances.s**term.power
            if term.law is not None:
                if isinstance(self.assembly.laws[term.law], PlacedLaw):
                    text = "rigid connections hold its twist still, so that its torque is not determined"
                    raise UsageError(f"{self.assembly.owners[term.law]}: {text}", kind="indeterminate-torque")
                inertia, damping, stiffness = (
                    part[term.law] for part in (system.inertia, system.damping, system.stiffness)
                )
                kappa = inertia * receptances.s**2 + damping * receptances.s + stiffness
                if term.law in dynamic:
                    kappa = kappa + np.asarray(dynamic[term.law].kappa(receptances.s.imag))
            over_q += (float(term.factor) * kappa)[:, None] * term.row
        for number, factor in reading.actions.items():
            action = self.assembly.system.actions[number]
            kappa = float(factor) * action.kappa(receptances.s)
            over_q += kappa[:, None] * self.assembly.over_coordinates(action.sensed)
        over_inputs = np.array([float(reading.direct(channel.row)) for channel in self.inputs], dtype=complex)
        return over_q, over_laws, over_inputs


def _reference(law: MotionLaw) -> float:
    """Spring k_0 in N m/rad that stands beside a law over the twist: the stiffest of its pieces."""
    curve = law.curve
    if curve.over == "rate":
        return 0.0
    if isinstance(curve, PieceCurve):
        stiffest = max((float(piece.stiffness) for piece in curve.pieces if isinstance(piece, Slope)), default=0.0)
        return float(law.scale) * stiffest
    if isinstance(curve, CubicCurve):
        return float(law.scale) * (abs(float(curve.stiffness)) or abs(float(curve.cubic)))
    from torsionnet.model.element_base.laws import MotionState

    return float(law.scale) * abs(float(curve.slopes(MotionState())[0])) or 1.0


def _scaled(D: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Stiffness with ones on its diagonal, and the scales (n_q,) of its rows and columns."""
    sizes = np.sqrt(np.abs(np.diag(D)))
    scale = 1 / np.where(sizes > 0, sizes, 1.0)
    return scale[:, None] * D * scale, scale


def _held(D: FloatArray) -> FloatArray:
    """Inverse of the stiffness at rest on the motions that it resists; what turns freely stays where it is."""
    scaled, scale = _scaled(D)
    left, sizes, right = np.linalg.svd(scaled)
    kept = sizes > FREE * sizes.max(initial=0.0)
    inverse = (right[kept].T / sizes[kept]) @ left[:, kept].T
    return np.asarray(scale[:, None] * inverse * scale)
