"""First harmonic of a drivetrain with a law of motion at the steps of a sine test, as a function of its parameters.

The element with the law is taken out; a spring k_0 stays in its place. What is left is linear, with receptances from
the torque u and from a torque between the ends of the element. With the describing functions K(a) of its laws

    gamma = a_g u - b_g tau,   y = a_y u - b_y tau,   tau = (K(|gamma|) - k_0) gamma.

Over frequency one torque has several such motions where the backbone leans over. Newton's method begins at the twist
that was measured, so that each step is compared with the branch it was on; beyond a fold, where the model has none, it
ends where the equation is missed least.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np

from torsionnet.base.errors import SolveError, UsageError
from torsionnet.base.expressions import FLOAT, ExpressionError
from torsionnet.identification.residuals.laws_over_time import stiffness_along, stiffness_by_harmonics
from torsionnet.linear.assembly.assembled import AssembledModel
from torsionnet.linear.assembly.rows import ComplexArray, FloatArray
from torsionnet.linear.dynamic_stiffness.transfer_request import named_output
from torsionnet.linear.sensitivity.parametric import Evaluation, ParametricResponse, parametric_response
from torsionnet.linear.sensitivity.unknowns import Unknowns, unknowns
from torsionnet.model.channels import Sensor
from torsionnet.model.element_base.element import OtherLaws
from torsionnet.model.element_base.laws import WholePart
from torsionnet.model.elements import GROUND, Element, Law, MotionLaw, Part, Row, Values
from torsionnet.model.motion_laws.element_stiffness import slider_of, stiffness_over_twists
from torsionnet.signals.stepped_levels import HARMONICS

RELATIVE_STEP = 1e-6
"""Relative step by which the describing functions are differenced; they are smooth but at the corners of laws."""
MOST_STEPS, SETTLED = 60, 1e-11
"""Most steps of Newton's method, and the change of all twists, over their size, below which it ends."""
SLOW = 1e-4
"""Part of the lowest frequency at which what is linear answers as at rest, also where it turns freely."""
MOST_KEPT = 64
"""Most sets of values of the unknowns of which the laws are kept."""
NO_SINE = 0.005
"""Harmonics of a twist over the first one, root of their sum of squares, from which it is no sine."""
SAME_TWIST = 1e-6
"""Share by which an output may differ from a multiple of a twist."""
FIRST_DAMPING, MOST_DAMPING = 1e-3, 1e6
"""Damping of Newton's steps at first, over the size of the slope, and that at which no step helps any more; it falls
with each step that helps."""


@dataclass(frozen=True)
class LinearBeside(OtherLaws):
    """Laws of an element without its laws of motion, with a spring (or none) in the place of all on its twist."""

    stiffness: float

    def parts(self, value: Values) -> tuple[Part, ...]:
        row = self.element.twist(value)
        beside = [
            part
            for part in self.element.whole_parts(value)
            if not isinstance(part, MotionLaw) and not (isinstance(part, Law) and part.row == row)
        ]
        return (Law(row, stiffness=self.stiffness), *beside)


@dataclass(frozen=True, eq=False)
class LawsOnTwist:
    """Elements with laws of motion, all on one twist, and what is linear beside them, as functions of parameters.

    Attributes
    ----------
    drivetrain : AssembledModel
    unknowns : Unknowns
    elements : tuple of str
    linear : ParametricResponse or None
        Output, twist and measured torque over what drives and torques at the ends of the element; None where the torque
        of the element itself is measured over its twist.
    row : Row
        Twist of the element over nodes, without those that stand still.
    spring : float
        k_0 in N m/rad.
    """

    drivetrain: AssembledModel
    unknowns: Unknowns
    elements: tuple[str, ...]
    linear: ParametricResponse | None
    row: Row
    spring: float

    @property
    def names(self) -> tuple[str, ...]:
        return self.unknowns.names

    @property
    def start(self) -> FloatArray:
        """Values (n,) of the unknowns in the model as given, in SI units."""
        return np.array(self.unknowns.start)


@dataclass(frozen=True, eq=False)
class SteppedCurve(LawsOnTwist):
    """First harmonic of an output over that of a torque at the steps of a sine test, as a function of parameters.

    Attributes
    ----------
    frequencies, torques, mean_twists : (n,) arrays
        Hz, N m and rad of the twist of the element at each step.
    measured : (n,) complex array
        Output over torque.
    shape : (n, 8) complex array or None
        Harmonics of the twist from the second on over the first, by its phase, where they are measured.
    at_harmonics : ParametricResponse or None
        The same as ``linear`` at harmonics of the steps, from the second on, one after the other.
    beyond : (n,) complex array, or 0
        What harmonics of the twist change of the complex stiffness, N m/rad.
    """

    frequencies: FloatArray
    torques: FloatArray
    mean_twists: FloatArray
    measured: ComplexArray
    unit: str = "rad/(N*m)"
    shape: ComplexArray | None = None
    at_harmonics: ParametricResponse | None = None
    beyond: ComplexArray | float = 0.0
    _known: dict[tuple[float, ...], tuple[tuple[Element, tuple[WholePart, ...], Row], ...]] = field(
        default_factory=dict, init=False, repr=False
    )

    @property
    def output_over_twist(self) -> float:
        """Multiple of the twist of the element that the output is at all frequencies; 0: it is none."""
        beside = self._beside(self.start.tolist())
        p = float((beside.output_by_torque / beside.by_torque)[0].real)
        pairs = (beside.output_by_torque, beside.by_torque), (beside.of_output, beside.of_twist)
        return p if all(np.allclose(output, p * twist, rtol=SAME_TWIST, atol=0) for output, twist in pairs) else 0.0

    @cached_property
    def omega(self) -> FloatArray:
        """Circular frequencies (n,) in rad/s."""
        return np.asarray(2 * np.pi * self.frequencies)

    def evaluation(self, values: Sequence[float] | FloatArray) -> Evaluation:
        """Output over torque (n, 1, 1) and derivatives (n, 1, 1, n_p), in SI units, at values (n_p,) of the unknowns.

        Raises
        ------
        SolveError
            They are not finite there.
        """
        numbers = [float(number) for number in values]
        beside = self._beside(numbers)
        gamma = self._twists(numbers, beside)
        size = np.abs(gamma)
        K, rises = self._stiffness(numbers, size), self._rise(numbers, size)
        tau, u = (K - self.spring) * gamma, self.torques
        # 0 = gamma - a_g u + b_g tau: d gamma = -(A, B)^-1 of what moves at fixed gamma.
        slopes = np.zeros((len(u), len(numbers)), dtype=complex)
        y = beside.of_output * u - beside.output_by_torque * tau
        for place in range(len(numbers)):
            moved = self._stiffness_slope(numbers, place, size) * gamma
            shift = (
                beside.slope("by_torque", place) * tau + beside.by_torque * moved - beside.slope("of_twist", place) * u
            )
            change = -_inverse(*self._linear_change(beside, K, rises, gamma), shift)
            along = (gamma.conj() * change).real / np.maximum(size, np.finfo(float).tiny)
            dtau = moved + (K - self.spring) * change + rises * along * gamma
            slopes[:, place] = (
                beside.slope("of_output", place) * u
                - beside.slope("output_by_torque", place) * tau
                - beside.output_by_torque * dtau
            )
        if not (np.isfinite(y).all() and np.isfinite(slopes).all()):
            given = ", ".join(f"{name} = {x:.6g}" for name, x in zip(self.names, numbers, strict=True))
            raise SolveError(f"the response is not finite at {given}", kind="not-finite")
        over = np.asarray(y / u, dtype=np.complex128)
        per_torque = np.asarray(slopes / u[:, None], dtype=np.complex128)
        return Evaluation(over[:, None, None], per_torque[:, None, None])

    def twists(self, values: Sequence[float] | FloatArray) -> ComplexArray:
        """First harmonics (n,) in rad of the twist of the element at the steps, of the branches nearest to the test."""
        numbers = [float(number) for number in values]
        return self._twists(numbers, self._beside(numbers))

    def unbalanced(self, values: Sequence[float] | FloatArray) -> tuple[ComplexArray, FloatArray]:
        """Torque (n,) in N m that the laws have too much at the twist measured, and how much of it an output moves.

        The second is in N m of torque over the unit of output over torque. Nothing is solved for: it is smooth in the
        parameters wherever the motions of the model are.
        """
        numbers = [float(number) for number in values]
        beside = self._beside(numbers)
        gamma, tau = self._measured_twist(beside)
        K, size = self._stiffness(numbers, np.abs(gamma)), np.abs(gamma)
        A, B = self._linear_change(beside, K, self._rise(numbers, size), gamma)
        moves = np.sqrt(np.abs(A) ** 2 + np.abs(B) ** 2) * self.torques / np.abs(beside.output_by_torque)
        return np.asarray((K - self.spring) * gamma - tau), np.asarray(moves)

    def with_harmonics(self, values: Sequence[float] | FloatArray) -> SteppedCurve:
        """Curve that takes along what harmonics change at values of the unknowns; itself where they are not known."""
        if self.at_harmonics is None or self.shape is not None:
            return self
        numbers = [float(number) for number in values]
        weights = np.array([float(weight) for weight in self.row.values()])
        by_torque = self.at_harmonics.evaluation(numbers).values[:, 1, 1:] @ weights
        laws, sizes = self._laws(tuple(numbers)), (np.abs(self.twists(numbers)), self.mean_twists, self.omega)
        receptances = by_torque.reshape(-1, len(self.torques)).T
        return replace(self, beyond=stiffness_by_harmonics(laws, *sizes, self.spring, receptances))

    def static_twists(self, outputs: FloatArray, torques: FloatArray) -> FloatArray:
        """Twists (n,) in rad of the element at mean outputs and torques, at the start values of what is linear."""
        beside = self._beside(self.start.tolist())
        tau = (beside.of_output * torques - outputs) / beside.output_by_torque
        return np.asarray((beside.of_twist * torques - beside.by_torque * tau).real)

    def _measured_twist(self, beside: Beside) -> tuple[ComplexArray, ComplexArray]:
        """Twist of the element, and torque beside the spring k_0, that the measured output asks for, each (n,)."""
        tau = (beside.of_output - self.measured) * self.torques / beside.output_by_torque
        return np.asarray(beside.of_twist * self.torques - beside.by_torque * tau), np.asarray(tau)

    def _twists(self, numbers: Sequence[float], beside: Beside) -> ComplexArray:
        gamma, _ = self._measured_twist(beside)
        damping = np.full(len(gamma), FIRST_DAMPING)
        missed = self._missed(numbers, beside, gamma)
        for _ in range(MOST_STEPS):
            size = np.abs(gamma)
            # Levenberg and Marquardt, with a damping for each frequency: less after a better step, more after a worse.
            slopes = self._linear_change(beside, self._stiffness(numbers, size), self._rise(numbers, size), gamma)
            step = _damped(*slopes, missed, damping)
            following = self._missed(numbers, beside, gamma - step)
            better = np.abs(following) < np.abs(missed)
            gamma, missed = np.where(better, gamma - step, gamma), np.where(better, following, missed)
            damping = np.where(better, damping / 10, np.minimum(damping * 10, MOST_DAMPING))
            if ((np.abs(step) <= SETTLED * np.abs(gamma)) | (damping >= MOST_DAMPING)).all():
                break
        return np.asarray(gamma)

    def _missed(self, numbers: Sequence[float], beside: Beside, gamma: ComplexArray) -> ComplexArray:
        tau = (self._stiffness(numbers, np.abs(gamma)) - self.spring) * gamma
        return np.asarray(gamma - beside.of_twist * self.torques + beside.by_torque * tau)

    def _linear_change(
        self, beside: Beside, K: ComplexArray, rises: ComplexArray, gamma: ComplexArray
    ) -> tuple[ComplexArray, ComplexArray]:
        """A and B of the change A d + B conj(d) of what is missed with a change d of the twist.

        tau grows by (K - k_0) d + K' gamma Re(conj(gamma) d)/|gamma|.
        """
        # Re(conj(gamma) d) is half of conj(gamma) d and its conjugate: one part stands with d, the other with conj(d).
        size = np.maximum(np.abs(gamma), np.finfo(float).tiny)
        return (
            1 + beside.by_torque * (K - self.spring + rises * size / 2),
            beside.by_torque * rises * gamma**2 / (2 * size),
        )

    def _stiffness(self, numbers: Sequence[float], amplitudes: FloatArray) -> ComplexArray:
        """Complex stiffness K (n,) of the laws of the element at the steps."""
        try:
            laws, at = self._laws(tuple(numbers)), (amplitudes, self.mean_twists, self.omega)
            of_laws = sum(stiffness_over_twists(*law, *at) for law in laws)
            beyond = self.beyond if self.shape is None else stiffness_along(laws, *at, self.shape)
            return np.asarray(of_laws + beyond)
        except (ZeroDivisionError, OverflowError, ExpressionError) as error:
            raise SolveError(f"the laws of {', '.join(self.elements)}: {error}", kind="no-solution") from None

    def _laws(self, numbers: tuple[float, ...]) -> tuple[tuple[Element, tuple[WholePart, ...], Row], ...]:
        """Elements with their parts and their twist at values of the unknowns, kept for the next amplitudes."""
        if numbers not in self._known:
            if len(self._known) >= MOST_KEPT:
                self._known.clear()
            given = {name: float(number) for name, number in self.unknowns.values(numbers).items()}
            value, elements = Values(given, FLOAT), self.unknowns.definition.elements
            self._known[numbers] = tuple(laws_of(elements[name], value) for name in self.elements)
        return self._known[numbers]

    def _rise(self, numbers: Sequence[float], amplitudes: FloatArray) -> ComplexArray:
        """Derivative (n,) of K with the amplitude, N m/rad^2."""
        step = RELATIVE_STEP * np.maximum(amplitudes, np.finfo(float).tiny)
        above, below = (self._stiffness(numbers, amplitudes + sign * step) for sign in (1, -1))
        return np.asarray((above - below) / (2 * step))

    def _stiffness_slope(self, numbers: Sequence[float], place: int, amplitudes: FloatArray) -> ComplexArray:
        """Derivative (n,) of K with one of the unknowns."""
        step = RELATIVE_STEP * (abs(numbers[place]) or abs(self.start[place]) or 1.0)
        ends = []
        for sign in (1, -1):
            moved = list(numbers)
            moved[place] += sign * step
            ends.append(self._stiffness(moved, amplitudes))
        return np.asarray((ends[0] - ends[1]) / (2 * step))

    def _beside(self, numbers: Sequence[float]) -> Beside:
        """Receptances of the linear part, with derivatives."""
        if self.linear is None:
            # The twist alone: T = K gamma is gamma - T/k_0 + (K - k_0) gamma/k_0 = 0, and the output is the twist.
            constant = np.full(len(self.torques), 1 / self.spring + 0j)
            none = np.zeros((len(self.torques), len(numbers)))
            return Beside(constant, constant, constant, constant, (none,) * 4)
        return beside_of(self.linear, self.row, numbers)


@dataclass(frozen=True, eq=False)
class Beside:
    """Receptances (n,) in rad/(N m), a_g, b_g, a_y and b_y of the text of the module, and their derivatives."""

    of_twist: ComplexArray
    by_torque: ComplexArray
    of_output: ComplexArray
    output_by_torque: ComplexArray
    slopes: tuple[ComplexArray | FloatArray, ...]

    def slope(self, name: str, place: int) -> ComplexArray:
        """Derivative (n,) of one of them with an unknown."""
        number = ("of_twist", "by_torque", "of_output", "output_by_torque").index(name)
        return np.asarray(self.slopes[number][:, place])


def beside_of(linear: ParametricResponse, row: Row, numbers: Sequence[float]) -> Beside:
    """Receptances of what is linear, under the torque that drives or the one that is measured, with derivatives."""
    evaluation = linear.evaluation(numbers)
    weights = np.array([float(weight) for weight in row.values()])
    driven, slopes = evaluation.values[:, :, 0], evaluation.jacobian[:, :, 0]
    between, between_slopes = (
        evaluation.values[:, :, 1:] @ weights,
        np.einsum("foip,i->fop", evaluation.jacobian[:, :, 1:], weights),
    )
    if driven.shape[1] == 3:
        # The torque measured is T = a_T u - b_T tau: u = (T + b_T tau)/a_T, put into the other rows.
        per_torque, change = 1 / driven[:, 2:], slopes[:, 2:]
        ratio = driven[:, :2] * per_torque
        ratio_slopes = (slopes[:, :2] - ratio[:, :, None] * change) * per_torque[:, :, None]
        moved = between_slopes[:, :2] - ratio_slopes * between[:, 2:, None] - ratio[:, :, None] * between_slopes[:, 2:]
        between, between_slopes = between[:, :2] - ratio * between[:, 2:], moved
        driven, slopes = ratio, ratio_slopes
    parts = (driven[:, 1], between[:, 1], driven[:, 0], between[:, 0])
    return Beside(*parts, (slopes[:, 1], between_slopes[:, 1], slopes[:, 0], between_slopes[:, 0]))


def _inverse(A: ComplexArray, B: ComplexArray, right: ComplexArray) -> ComplexArray:
    """Solutions d (n,) of A d + B conj(d) = right, of least squares where a fold has none."""
    return _damped(A, B, right, np.full(len(A), 1e-12))


def _damped(A: ComplexArray, B: ComplexArray, right: ComplexArray, damping: FloatArray) -> ComplexArray:
    # Normal equations of Levenberg and Marquardt: (P + mu) d + Q conj(d) = s.
    P, Q, s = np.abs(A) ** 2 + np.abs(B) ** 2, 2 * A.conj() * B, A.conj() * right + B * right.conj()
    # With its conjugate two equations for d and conj(d), solved by Cramer's rule.
    P = P * (1 + damping)
    return np.asarray((P * s - Q * s.conj()) / (P**2 - np.abs(Q) ** 2))


def stepped_curve(
    rig: AssembledModel,
    output: str,
    into: str,
    excitation: str | None,
    parameters: tuple[str, ...],
    steps: tuple[FloatArray, FloatArray, FloatArray, FloatArray, ComplexArray],
    shape: ComplexArray | None = None,
) -> SteppedCurve:
    """First harmonic of an output of a model over a torque at ``steps``.

    These are frequencies, amplitudes of the torque, means of output and torque, and the output measured over torque;
    ``shape`` has the further harmonics of the output over the first.

    Raises
    ------
    UsageError
        The model has no law of motion, laws on several twists, or names that it lacks.
    """
    varied = unknowns(rig, parameters)
    elements, row = on_one_twist(rig)
    frequencies, torques, means, mean_torques, measured = steps
    at_start = Values(dict(rig.exact_values), FLOAT)
    sizes = (np.abs(measured) * torques, means, 2 * np.pi * frequencies)
    typical = sum(
        np.abs(stiffness_over_twists(*laws_of(rig.definition.elements[name], at_start), *sizes)) for name in elements
    )
    spring = float(np.median(typical)) or 1.0
    drive, sensor = rig.sensors.get(output), rig.sensors.get(into)
    common = (spring, frequencies, torques, means, measured)
    if sensor is not None and sensor.quantity == "torque" and sensor.of in elements:
        if drive is None or (drive.quantity, drive.of) != ("twist", sensor.of):
            text = (
                f"the torque of {sensor.of} goes with its twist; name a sensor {{twist: {sensor.of}}}, or what drives"
            )
            raise UsageError(text, kind="unfit-channel")
        return SteppedCurve(rig, varied, (sensor.of,), None, row, *common, shape=_clear(shape))
    linear_rig, held = linear_beside(varied, rig, elements, row, spring)
    if (measured_in := named_output(linear_rig, output).unit) != "rad":
        text = f"steps have a twist or an angle in rad over a torque, and {output} is in {measured_in}"
        raise UsageError(f"{text}; name a sensor of an angle or a twist", kind="unfit-channel")
    if excitation and sensor is None:
        text = f"{into} drives itself, so that the excitation {excitation} has no effect; leave it out"
        raise UsageError(text, kind="needless-entry")
    outputs, driving = channels_beside(rig, output, into, excitation, elements[0])

    def linear(at: FloatArray) -> ParametricResponse:
        return parametric_response(linear_rig, outputs, [driving, *held], at, varied.parameters)

    curve = SteppedCurve(rig, varied, elements, linear(frequencies), held, *common)
    still = replace(curve, linear=linear(np.array([SLOW * frequencies.min()])))
    harmonics = linear(np.outer(np.arange(2, HARMONICS + 1), frequencies).ravel())
    curve = replace(curve, mean_twists=still.static_twists(means, mean_torques), at_harmonics=harmonics)
    clear, p = _clear(shape), curve.output_over_twist
    if clear is None or not p:
        return curve
    # By the phase of the first one, even harmonics of a twist that the output reads backwards have the other sign.
    return replace(curve, shape=clear * np.sign(p) ** (np.arange(2, HARMONICS + 1) + 1))


def _clear(shape: ComplexArray | None) -> ComplexArray | None:
    """Harmonics of a twist over the first one; None where they are those of a sine with noise."""
    return None if shape is None or np.linalg.norm(shape, axis=1).max() < NO_SINE else shape


def linear_beside(
    varied: Unknowns, rig: AssembledModel, elements: Sequence[str], row: Row, spring: float
) -> tuple[AssembledModel, Row]:
    """Model with a spring in N m/rad in the place of elements with laws of motion, and their twist over free nodes."""
    # In the definition with a parameter for every unknown: replacing an entry later would put the laws back.
    plain, replaced = varied.definition, {}
    for place, name in enumerate(elements):
        beside = LinearBeside(plain.elements[name], 0.0 if place else spring)
        replaced[name] = plain.elements[name].unchecked(other_laws=beside, referred_to=None)
    linear = rig.with_definition(replace(plain, elements={**plain.elements, **replaced}, tangents=None))
    nodes = zip(linear.assembly.kinematics.nodes, linear.assembly.node_rows.maps, strict=True)
    held_still = {GROUND, *(node for node, moves in nodes if not moves)}
    return linear, {node: row[node] for node in row if node not in held_still}


def channels_beside(
    rig: AssembledModel, output: str, into: str, excitation: str | None, element: str
) -> tuple[list[str | Sensor], str]:
    """Output, twist of an element and torque where one is measured; and what drives."""
    outputs: list[str | Sensor] = [output, Sensor("twist", element)]
    return ([*outputs, into], _driving(rig, excitation)) if into in rig.sensors else (outputs, into)


def _driving(rig: AssembledModel, excitation: str | None) -> str:
    if excitation or len(rig.inputs) == 1:
        return excitation or next(iter(rig.inputs))
    text = "a measured torque needs to know which input drives it: name it by excitation"
    raise UsageError(text, kind="wrong-count")


def on_one_twist(rig: AssembledModel) -> tuple[tuple[str, ...], Row]:
    """Names of the elements with laws of motion, and the row of node angles that is the twist of them all."""
    value = Values(dict(rig.exact_values), FLOAT)
    active = rig.definition.switched_on
    # A linear spring is a law, too, and perhaps the wrong one.
    moving = [element for element in active if _moves(element, value)] or [
        element for element in active if element.kind == "spring"
    ]
    if not moving:
        text = "steps at several amplitudes tell of laws of motion and springs, and the model has none"
        raise UsageError(text, kind="no-effect")
    rows = [element.twist(value) for element in moving]
    if any(row != rows[0] for row in rows[1:]):
        names = ", ".join(element.name for element in moving)
        text = f"{names} have laws of motion on several twists, which one output does not tell apart"
        raise UsageError(
            f"{text}; lock one, or measure the torque and the twist of one element", kind="unsupported-law"
        )
    return tuple(element.name for element in moving), rows[0]


def names_of_laws(varied: Unknowns, elements: Sequence[str]) -> tuple[str, ...]:
    """Names of the unknowns that elements with laws of motion have."""
    given = [entry for name in elements for entry in varied.definition.elements[name].expressions()]
    used = {name for _, _, expression, _ in given for name in expression.names}
    return tuple(name for name, parameter in zip(varied.names, varied.parameters, strict=True) if parameter in used)


def springs_of_sliders(varied: Unknowns, elements: Sequence[str], values: FloatArray) -> dict[str, float]:
    """Twist in rad at which a slider begins to slip, by the name of the unknown that its spring is."""
    limits: dict[str, float] = {}
    value = Values({name: float(number) for name, number in varied.values(values.tolist()).items()}, FLOAT)
    for element, parts, _ in (laws_of(varied.definition.elements[name], value) for name in elements):
        spring = getattr(element, "stiffness", None)
        if element.kind == "friction" and spring is not None:
            stiffness, torque = slider_of(element, parts)
            pairs = zip(varied.names, varied.parameters, strict=True)
            limits |= {name: torque / stiffness for name, parameter in pairs if parameter in spring.names}
    return limits


def laws_of(element: Element, value: Values) -> tuple[Element, tuple[WholePart, ...], Row]:
    """Element with its parts, laws of motion in full, and the row of its twist."""
    return element, element.whole_parts(value), element.twist(value)


def _moves(element: Element, value: Values) -> bool:
    if element.over_time is not element:
        return True  # arc springs, which have no describing function without their history
    return element.has_motion_laws and any(isinstance(part, MotionLaw) for part in element.whole_parts(value))
