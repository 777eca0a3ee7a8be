"""Dual mass flywheel: two masses with arc springs and friction between them."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any, ClassVar, Self

from torsionnet.base.entries.composite import one_exactly
from torsionnet.base.entries.scalars import PhysicalQuantity
from torsionnet.base.entries.spec import Spec, entry
from torsionnet.base.errors import EntryPath, Fault
from torsionnet.base.expressions import Expression, Number
from torsionnet.model.damping import DampingMeasure, DampingQuantity, LossFactor, loss_factor
from torsionnet.model.element_base.curves import with_curve_ranges
from torsionnet.model.element_base.element import Element, register, viscous
from torsionnet.model.element_base.element_entries import NodePair, shown
from torsionnet.model.element_base.laws import (
    AT_REST,
    GROUND,
    Constraint,
    Law,
    MotionLaw,
    MotionState,
    Part,
    Values,
    WholePart,
    difference,
    make_row,
)
from torsionnet.model.element_base.spring_stage import (
    SpringStage,
    stage_at,
    stage_faults,
    stage_range,
    stage_torques,
)
from torsionnet.model.element_base.spring_stages import SpringStages
from torsionnet.model.motion_laws.piece_curve import Hold, PieceCurve, Slope, friction_curve, stage_curve

_STUCK = 1
"""Number of the step of :func:`.friction_curve`, between the pieces on either side of it."""
_CENTRIFUGAL = ("friction_coefficient", "spring_mass", "spring_radius", "speed")
_ARC = ("stiffness", *_CENTRIFUGAL, "torque", "swing")
"""Entries that springs on an arc need."""


@register
@dataclass(frozen=True, eq=False, repr=False)
class DualMassFlywheel(Element):
    r"""A dual mass flywheel: J_1 and J_2 with arc springs and friction between them.

    The springs have a stiffness k, or stages T(gamma) as those of ``spring``; linear results take the stage which the
    mean ``torque`` has brought into force, without it the torque of the operating point. A share b of the coils that
    friction holds fast at the swing in question leaves k/(1 - b).
    Friction M loses 4 M alpha in a cycle of swing alpha, which a loss factor 4 M/(pi k alpha) loses too (harmonic
    balance; J. P. Den Hartog, Mechanical Vibrations, 4th ed., chapter 8), so that the law is
    k (1 + j (eta + 4 M/(pi k alpha))) + c s. M is the basic friction and that of springs pressed outward against
    their channel, M = M_0 + mu m r^2 Omega^2, m and r the mass and radius of all of them.

    With an ``arc_angle`` psi the springs are those of ``arc_spring``: friction grows with the spring force as well,
    ``blocked`` follows from the swing, and ``torque``, ``swing`` and the entries of pressed springs give k' and k''/k'
    in place of k and M. A lumped friction M cannot do this: its loss 4 M alpha is in proportion to the swing, and
    nothing at standstill; that of arc springs grows with alpha^1.5 and with the torque, and their stiffness falls.

    Its law of motion in time is T(gamma/(1 - b)) + M sgn(gamma') + c gamma'; at rest the friction takes any torque from
    -M to M beside the springs. A loss factor has no motion in time: give the losses as friction and damping. Small
    vibrations that friction holds do not move the springs at all, so that without ``swing`` linear results take a
    flywheel with friction as rigid.

    Examples
    --------
    >>> dmf = DualMassFlywheel("dmf", nodes=("crank", "gearbox"), primary_inertia=0.09, secondary_inertia=0.05,
    ...     stages=[{"stiffness": "6 N*m/deg", "to": "120 N*m"}, {"stiffness": "14 N*m/deg"}], torque="200 N*m",
    ...     friction="8 N*m", swing="3 deg")
    >>> springs = dmf.parts(Values({}))[0]
    >>> round(springs.stiffness), round(springs.loss_factor, 4)
    (802, 0.2425)
    """

    kind: ClassVar[str] = "dual_mass_flywheel"
    glyph: ClassVar[str] = "spring"
    working_point: ClassVar[tuple[str, ...]] = ("torque", "swing")
    when_stuck: ClassVar[str] = "give swing, as 3 deg, the amplitude at which friction lets the springs move"

    nodes: tuple[str, str] = entry(
        NodePair("primary and secondary side; twist is the angle of the first minus the second")
    )
    primary_inertia: Expression = entry(PhysicalQuantity("inertia of the primary side", "inertia", "J_1"))
    secondary_inertia: Expression = entry(PhysicalQuantity("inertia of the secondary side", "inertia", "J_2"))
    stiffness: Expression | None = entry(
        PhysicalQuantity("stiffness of the arc springs at the working point", "stiffness", "k", exclusive=True), None
    )
    stages: tuple[SpringStage, ...] = entry(
        SpringStages("instead: stages of the springs, each up to a torque or an angle"), None
    )
    torque: Expression | None = entry(
        PhysicalQuantity("mean torque, which tells the stage; default: by the operating point", "torque", "T", None),
        None,
    )
    blocked: Expression = entry(PhysicalQuantity("share of the coils that friction holds fast", "1", "b"), 0)
    loss_factor: Expression | DampingMeasure = entry(
        LossFactor("loss factor of the springs, or another measure of it", "1", "eta"), 0
    )
    damping: Expression | DampingMeasure = entry(DampingQuantity("viscous damping in parallel", "damping", "c"), 0)
    friction: Expression = entry(PhysicalQuantity("basic friction", "torque", "M_0"), 0)
    swing: Expression | None = entry(
        PhysicalQuantity(
            "amplitude of the twist, for friction; none: friction holds the springs", "angle", "alpha", exclusive=True
        ),
        None,
    )
    friction_coefficient: Expression | None = entry(PhysicalQuantity("between springs and channel", "1", "mu"), None)
    spring_mass: Expression | None = entry(PhysicalQuantity("mass of all arc springs", "mass", "m"), None)
    spring_radius: Expression | None = entry(PhysicalQuantity("radius on which they lie", "length", "r"), None)
    speed: Expression | None = entry(PhysicalQuantity("speed that presses them outward", "speed", "Omega", None), None)
    arc_angle: Expression | None = entry(
        PhysicalQuantity(
            "angle on which a spring lies, for friction that grows with its force", "angle", "psi", exclusive=True
        ),
        None,
    )

    def contradictions(self) -> list[Fault]:
        return [*self._spring_faults(), *self._friction_faults(), *self._arc_faults()]

    def _arc_faults(self) -> list[Fault]:
        """Faults of springs on an arc that lack entries, or say twice how friction holds them."""
        if self.arc_angle is None:
            return []
        given = [name for name in _ARC if getattr(self, name) is not None]
        if len(given) < len(_ARC):
            missing = " and ".join(name for name in _ARC if name not in given)
            return [Fault(f"arc_angle needs {', '.join(_ARC)}; here is no {missing}", kind="missing-entry")]
        if self.blocked != Number(0):
            text = "with arc_angle the coils that friction locks follow from the swing; leave out blocked"
            return [Fault(text, ("blocked",), on_key=True, kind="contradicting-entries")]
        return []

    def _spring_faults(self) -> list[Fault]:
        wrong = one_exactly(self, "stiffness", "stages")
        if wrong:
            return wrong
        if not isinstance(self.torque, Number) or not stage_range(self.stages):
            return []
        return self._torque_faults(Values({}))

    def _torque_faults(self, value: Values) -> list[Fault]:
        """Fault of a mean torque beyond the end of the last stage."""
        if self.torque is None or stage_at(self.stages, value(self.torque), value) is not None:
            return []
        last = shown(None, stage_torques(self.stages, value)[-1])
        return [
            Fault(
                f"the last stage ends at {last} N*m; leave out its end, or reduce the torque",
                ("torque",),
                kind="contradicting-values",
            )
        ]

    def value_faults(self, value: Values) -> list[Fault]:
        if not self.stages:
            return []
        return [fault.under("stages") for fault in stage_faults(self.stages, value)] or self._torque_faults(value)

    def expressions(self) -> Iterator[tuple[EntryPath, Spec[object], Expression, str]]:
        """Path, specification, expression and dimension of every expression in the flywheel's entries.

        The mean torque has to lie within the stages.
        """
        yield from with_curve_ranges(super().expressions(), {"torque": (stage_range(self.stages), 1)})

    def _friction_faults(self) -> list[Fault]:
        if isinstance(self.blocked, Number) and self.blocked.value >= 1:
            return [
                Fault(
                    "blocked must be below 1: with all coils blocked nothing is elastic",
                    ("blocked",),
                    kind="out-of-range",
                )
            ]
        given = [name for name in _CENTRIFUGAL if getattr(self, name) is not None]
        if given and self.arc_angle is None and len(given) < len(_CENTRIFUGAL):
            missing = " and ".join(name for name in _CENTRIFUGAL if name not in given)
            return [
                Fault(
                    f"friction of springs pressed outward needs {', '.join(_CENTRIFUGAL)}; here is no {missing}",
                    kind="missing-entry",
                )
            ]
        return []

    @property
    def _rubs(self) -> bool:
        return self.friction_coefficient is not None or self.friction != Number(0)

    @property
    def has_motion_laws(self) -> bool:
        # Springs on an arc are linear about their own working point, but for motion over time.
        return self.arc_angle is None and (bool(self.stages) or self._rubs)

    @property
    def over_time(self) -> Self:
        if self.arc_angle is None or self.other_laws is not None:
            return super().over_time
        from torsionnet.model.arc_spring.arc_curve import LawsOverTime  # few flywheels give an arc

        return self.with_laws(LawsOverTime(self))

    @property
    def has_own_working_point(self) -> bool:
        """Whether the entries say which stage is in force, and how friction acts."""
        return (not self.stages or self.torque is not None) and (not self._rubs or self.swing is not None)

    def own_parts(self, value: Values) -> tuple[Part, ...]:
        return self.tangent_parts(value)

    def own_tangent_parts(self, value: Values, states: Sequence[MotionState] = ()) -> tuple[Part, ...]:
        """Parts of the flywheel for small motion about states of its springs in stages and of its friction.

        Without states the mean torque tells the stage, and the swing how friction acts.
        """
        if self.arc_angle is not None:
            return (self._arc_law(value), *self._masses(value))
        given = iter(states)
        springs = next(given, None) if self.stages else None
        friction = next(given, AT_REST) if self._rubs else None
        stiffness, held = self._tangent(springs, value)
        eta = loss_factor(self.loss_factor, value.parameters, value.algebra)
        if self.swing is not None:
            # Harmonic balance (Den Hartog, chapter 8): 4 M alpha lost in a cycle is a loss factor 4 M/(pi k alpha).
            eta = eta + 4 * self._friction(value) / (value.algebra.pi * stiffness * value(self.swing))
        elif friction is not None:
            # Small vibrations do not move springs that friction holds; only a flywheel that slides stays elastic.
            held = held or (friction.rate == 0 if friction.piece is None else friction.piece == _STUCK)
        damping = viscous(self.damping, stiffness, value)
        row = difference(*self.nodes)
        law = Law(row, damping=damping, stiffness=stiffness, loss_factor=eta)
        return (law, *([Constraint(row)] if held else []), *self._masses(value))

    def _arc_law(self, value: Values) -> Law:
        """Springs on an arc at their swing, with basic friction and a loss factor of their own beside them."""
        from torsionnet.model.arc_spring.linear_law import arc_stiffness, arc_values  # few flywheels give an arc

        stiffness, eta = arc_stiffness(value.algebra, *(value(number) for number in arc_values(self)))
        eta = eta + loss_factor(self.loss_factor, value.parameters, value.algebra)
        if self.friction != Number(0):
            eta = eta + 4 * value(self.friction) / (value.algebra.pi * stiffness * value(self.swing))
        damping = viscous(self.damping, stiffness, value)
        return Law(difference(*self.nodes), damping=damping, stiffness=stiffness, loss_factor=eta)

    def _tangent(self, springs: MotionState | None, value: Values) -> tuple[Any, bool]:
        """Stiffness in force at a state of springs in stages, and whether a preload lets them stand still there."""
        # With the share b of the coils held fast the others, 1 - b of them, give k/(1 - b).
        whole = 1 - value(self.blocked)
        if springs is None and (self.torque is not None or not self.stages):
            return self._stiffness(value) / whole, False
        # This curve is shortened by 1 - b already.
        curve = self._curve(value)
        state = AT_REST if springs is None else springs
        return curve.slopes(state)[0], curve.holds(state)

    def own_whole_parts(self, value: Values) -> tuple[WholePart, ...]:
        if not self.has_motion_laws:
            return self.parts(value)
        row = difference(*self.nodes)
        stiffness, _ = self._tangent(None, value)
        damping = viscous(self.damping, stiffness, value)
        eta = loss_factor(self.loss_factor, value.parameters, value.algebra)
        springs: list[WholePart] = []
        # The stages act as T(gamma/(1 - b)); what is linear beside them, c and eta, keeps a law of its own.
        if self.stages:
            springs.append(MotionLaw(row, self._curve(value)))
        rest = Law(row, damping=damping, stiffness=0 if self.stages else stiffness, loss_factor=eta)
        if rest.acts or eta != 0:
            springs.append(rest)
        if self._rubs:
            # M sgn(gamma'): friction holds as much at rest, M, as it has in sliding.
            friction = self._friction(value)
            springs.append(MotionLaw(row, friction_curve(friction, friction)))
        return (*springs, *self._masses(value))

    def _masses(self, value: Values) -> list[Law]:
        sides = zip(self.nodes, (self.primary_inertia, self.secondary_inertia), strict=True)
        masses = [Law(make_row([(node, 1)]), inertia=value(inertia)) for node, inertia in sides if node != GROUND]
        return [law for law in masses if law.acts]

    def _curve(self, value: Values) -> PieceCurve:
        """Curve of the springs in stages, shortened by the share of their coils that friction holds."""
        # T(gamma/(1 - b)): twists shrink by 1 - b at the same torque, and stiffnesses grow by 1/(1 - b).
        curve, free = stage_curve(self.stages, value), 1 - value(self.blocked)

        def shortened(piece: Slope | Hold) -> Slope | Hold:
            if isinstance(piece, Hold):
                return replace(piece, at=piece.at * free)
            lower, upper = (None if end is None else end * free for end in (piece.lower, piece.upper))
            return replace(piece, stiffness=piece.stiffness / free, lower=lower, upper=upper)

        return replace(curve, pieces=tuple(shortened(piece) for piece in curve.pieces))

    def _stiffness(self, value: Values) -> Any:
        if self.stiffness is not None:
            return value(self.stiffness)
        stage = stage_at(self.stages, value(self.torque), value) or self.stages[-1]  # checks say if it lies beyond
        return value(stage.stiffness)

    def _friction(self, value: Values) -> Any:
        if self.speed is None:
            return value(self.friction)
        pressed = value(self.spring_mass) * value(self.spring_radius) ** 2 * value(self.speed) ** 2
        return value(self.friction) + value(self.friction_coefficient) * pressed
