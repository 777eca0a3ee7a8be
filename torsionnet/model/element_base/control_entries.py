"""Entries of a controller for the motion that it senses and its control law."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any, TypeAlias

from torsionnet.base.entries.scalars import SCALAR_SCHEMA, plain_scalar, read_scalar
from torsionnet.base.entries.spec import EntryError, Json, Renaming, Schema, Spec, coerce_part, full_name
from torsionnet.base.errors import BRACKET, EntryPath, Fault, Remedy, did_you_mean, got, unfit_word
from torsionnet.base.expressions import Expression, Number
from torsionnet.model.element_base.element_entries import TURNING_NODE, NodePair
from torsionnet.model.element_base.laws import GROUND, Values

# Control law, the torque over the sensed motion as a quotient of polynomials, in any algebra.

Polynomial: TypeAlias = tuple[Any, ...]
"""Type of the coefficients of a polynomial, ascending in s."""
GAIN, PID, POLYNOMIALS, ROOTS, MATRICES = "gain", "PID", "polynomials", "zeros and poles", "state space"


@dataclass(frozen=True)
class ControlLaw:
    """Transfer function H(s) of a controller in the form in which the file gives it.

    Attributes
    ----------
    form : str
        ``gain``, ``PID``, ``polynomials``, ``zeros and poles`` or ``state space``.
    entries : tuple of (name, value)
        Expressions, or tuples of these; two of them deep for matrices and for pairs of roots.
    """

    form: str
    entries: tuple[tuple[str, Any], ...]

    def quotient(self, value: Values) -> tuple[Polynomial, Polynomial]:
        """Numerator and denominator of H(s), each as coefficients ascending in s, in the algebra of ``value``."""
        given = {name: _evaluated(entry, value) for name, entry in self.entries}
        if self.form == GAIN:
            return (given["gain"],), (1,)
        if self.form == PID:
            return _pid(given)
        if self.form == POLYNOMIALS:
            return given["numerator"][::-1], given["denominator"][::-1]
        if self.form == ROOTS:
            above = product((given["gain"],), _with_roots(given.get("zeros", ())))
            return above, _with_roots(given.get("poles", ()))
        return _of_matrices(given)


def _evaluated(entry: Any, value: Values) -> Any:
    return tuple(_evaluated(part, value) for part in entry) if isinstance(entry, tuple) else value(entry)


def _pid(given: dict[str, Any]) -> tuple[Polynomial, Polynomial]:
    """Numerator and denominator, ascending in s, of p + i/s + d s/(1 + T s), with T the filter's time constant."""
    # One fraction over s (1 + T s), without i over 1 + T s.
    lag: Polynomial = (1, given["filter"]) if "filter" in given else (1,)
    rate: Polynomial = (0, given["d"]) if "d" in given else ()
    if "i" not in given:
        return total(product((given.get("p", 0),), lag), rate), lag
    return total(product((given["i"], given.get("p", 0)), lag), (0, *rate) if rate else ()), product((0, 1), lag)


def _with_roots(roots: Sequence[Any]) -> Polynomial:
    """Coefficients of the monic polynomial of real roots and of pairs (re, im) of conjugate roots.

    A pair stands for re + j im and re - j im.
    """
    polynomial: Polynomial = (1,)
    for root in roots:
        # A pair re + j im and re - j im is the real factor s^2 - 2 re s + re^2 + im^2.
        polynomial = product(
            polynomial,
            (root[0] * root[0] + root[1] * root[1], -2 * root[0], 1) if isinstance(root, tuple) else (-root, 1),
        )
    return polynomial


def _of_matrices(given: dict[str, Any]) -> tuple[Polynomial, Polynomial]:
    """Numerator and denominator, ascending in s, of the state space that four matrices give.

    C (s I - A)^-1 B + D by the Faddeev-LeVerrier algorithm, which divides by whole numbers only.
    """
    A, B, C, D = (given[name] for name in "ABCD")
    n, zero = len(A), 0 * D
    adjugate = [[zero + (1 if i == j else 0) for j in range(n)] for i in range(n)]
    below, above = [1], []
    # Faddeev-LeVerrier: M_1 = I, a_k = -tr(A M_k)/k, then A M_k + a_k I for the next; C M_k B goes with s^(n - k).
    for k in range(1, n + 1):
        above.append(sum((C[i] * adjugate[i][j] * B[j] for i in range(n) for j in range(n)), start=zero))
        moved = [[sum((A[i][m] * adjugate[m][j] for m in range(n)), start=zero) for j in range(n)] for i in range(n)]
        last = -sum((moved[i][i] for i in range(n)), start=zero) * Fraction(1, k)
        below.append(last)
        adjugate = [[moved[i][j] + (last if i == j else 0) for j in range(n)] for i in range(n)]
    denominator = tuple(reversed(below))
    return total(tuple(reversed(above)), product((D,), denominator)), denominator


def product(first: Polynomial, second: Polynomial) -> Polynomial:
    """Coefficients, ascending in s, of the product of two polynomials.

    >>> product((1, 2), (3, 0, 1))
    (3, 6, 1, 2)
    """
    coefficients: list[Any] = [0] * (len(first) + len(second) - 1)
    for i, a in enumerate(first):
        for j, b in enumerate(second):
            coefficients[i + j] = coefficients[i + j] + a * b
    return tuple(coefficients)


def total(first: Polynomial, second: Polynomial) -> Polynomial:
    """Coefficients, ascending in s, of the sum of two polynomials."""
    longer, shorter = (first, second) if len(first) >= len(second) else (second, first)
    return tuple(a + b for a, b in zip(longer, shorter, strict=False)) + longer[len(shorter) :]


SENSED_QUANTITIES = ("angle", "velocity", "acceleration")
"""Names of the motions that a controller can sense; the index is the power of s over the angle."""
_FORMS = {
    GAIN: {"gain"},
    PID: {"p", "i", "d", "filter"},
    POLYNOMIALS: {"numerator", "denominator"},
    ROOTS: {"zeros", "poles", "gain"},
    MATRICES: {"A", "B", "C", "D"},
}
_NEEDED = {GAIN: {"gain"}, PID: set(), POLYNOMIALS: _FORMS[POLYNOMIALS], ROOTS: {"gain"}, MATRICES: set("ABC")}
_WAYS = "a gain, {p, i, d, filter}, {numerator, denominator}, {zeros, poles, gain} or {A, B, C, D}"
_MOST_COEFFICIENTS = 50
"""Largest number of coefficients, roots or states of a control law, as more make polynomials that lose digits."""
_LARGEST_COEFFICIENT = 10**40
"""Largest coefficient of a control law, as larger numbers are slips and their products would overflow."""


@dataclass(frozen=True)
class SensedMotion:
    """Motion that a controller senses at a node, or between two nodes.

    Angle, velocity or acceleration of a node, or of a node relative to another.
    """

    quantity: str
    nodes: tuple[str, ...]

    @property
    def power(self) -> int:
        """Power of s over the angle that the sensed motion has.

        0 for an angle, 1 for a velocity, 2 for an acceleration.
        """
        return SENSED_QUANTITIES.index(self.quantity)


class SensedEntry(Spec[SensedMotion]):
    """Entry for the motion that a controller senses.

    ``{velocity: node}``, or ``{velocity: [first, second]}`` for first minus second.
    """

    def coerce(self, raw: object) -> SensedMotion:
        if isinstance(raw, SensedMotion):
            return raw
        if not isinstance(raw, Mapping) or len(raw) != 1:
            raise EntryError(f"expected what is sensed, as {{velocity: node}}, {got(raw)}", kind="wrong-form")
        ((quantity, of),) = raw.items()
        if quantity not in SENSED_QUANTITIES:
            hint = did_you_mean(str(quantity), SENSED_QUANTITIES)
            more = "; the torque of a spring is its stiffness times {angle: [node, node]}" if quantity != hint else ""
            text = f'a controller cannot sense "{quantity}"{hint}; known: {", ".join(SENSED_QUANTITIES)}{more}'
            raise EntryError(Fault(text, (quantity,), on_key=True, kind="unknown-word"))
        return SensedMotion(quantity, coerce_part(quantity, OneOrTwoNodes(""), of))

    def renamed(self, value: Any, names: Renaming) -> Any:
        return SensedMotion(value.quantity, tuple(map(names.node, value.nodes)))

    def plain(self, value: Any) -> Json:
        return {value.quantity: OneOrTwoNodes("").plain(value.nodes)}

    def schema(self) -> Schema:
        node = OneOrTwoNodes("a node, or the first of two against the second").schema()
        sensed: Schema = {
            "type": "object",
            "properties": dict.fromkeys(SENSED_QUANTITIES, node),
            "additionalProperties": False,
        }
        return {**sensed, "minProperties": 1, "maxProperties": 1, "description": self.description}

    @property
    def accepted(self) -> str:
        return f"{full_name(SensedMotion)} | collections.abc.Mapping[str, {OneOrTwoNodes('').accepted}]"


class OneOrTwoNodes(Spec[tuple[str, ...]]):
    """Entry for one node, or for a pair of nodes of which the second may be ground."""

    def renamed(self, value: Any, names: Renaming) -> Any:
        return tuple(map(names.node, value))

    def coerce(self, raw: object) -> tuple[str, ...]:
        if isinstance(raw, str) or (isinstance(raw, list | tuple) and len(raw) == 1):
            return (TURNING_NODE.coerce(raw if isinstance(raw, str) else raw[0]),)
        first, second = NodePair("").coerce(raw)
        if first == GROUND:
            raise EntryError(
                "ground does not move; name a node first, and ground second if at all", (0,), kind="grounded-node"
            )
        return (first,) if second == GROUND else (first, second)

    def plain(self, value: Any) -> Json:
        return value[0] if len(value) == 1 else list(value)

    def schema(self) -> Schema:
        name = {"type": "string"}
        pair: Schema = {"type": "array", "items": name, "minItems": 2, "maxItems": 2}
        return {"anyOf": [name, pair], "description": self.description}

    @property
    def accepted(self) -> str:
        return "str | TwoNames"


class ControlLawEntry(Spec[ControlLaw]):
    """Entry for the control law of a controller in any of its forms.

    Gain, PID, polynomials, zeros and poles, state space, or a python-control object.
    """

    def coerce(self, raw: object) -> ControlLaw:
        if isinstance(raw, ControlLaw):
            return raw
        raw = _from_control(raw)
        if not isinstance(raw, Mapping):
            if isinstance(raw, str | int | float | Expression) or hasattr(raw, "numerator"):
                return ControlLaw(GAIN, (("gain", _scalar(raw)),))
            raise EntryError(f"expected {_WAYS}, {got(raw)}", kind="wrong-form")
        return self._of_form(_form(raw), raw)

    def _of_form(self, form: str, raw: Mapping[str, Any]) -> ControlLaw:
        missing = [name for name in sorted(_NEEDED[form]) if name not in raw]
        if missing:
            raise EntryError(f"a law by {form} needs {' and '.join(missing)}", kind="missing-entry")
        if form == PID and not {"p", "i", "d"} & raw.keys():
            raise EntryError("give p, i or d; a filter alone does nothing", ("filter",), kind="missing-entry")
        read = _row if form in (POLYNOMIALS, ROOTS) else _scalar
        if form == MATRICES:
            return ControlLaw(form, _matrices(raw))
        names = ("numerator", "denominator", "zeros", "poles", "p", "i", "d", "filter", "gain")
        given = [name for name in names if name in raw]
        entries = tuple((name, _at(name, _scalar if name == "gain" else read, raw[name])) for name in given)
        law = ControlLaw(form, entries)
        _require_proper_entries(law)
        return law

    def plain(self, value: Any) -> Json:
        if value.form == GAIN:
            return plain_scalar(value.entries[0][1])
        return {name: _plain(entry) for name, entry in value.entries}

    def schema(self) -> Schema:
        scalars: Schema = {"type": "array", "items": SCALAR_SCHEMA}
        roots: Schema = {"type": "array", "items": {"anyOf": [SCALAR_SCHEMA, scalars]}}
        rows: Schema = {"type": "array", "items": {"anyOf": [SCALAR_SCHEMA, scalars]}}
        kinds: Schema = dict.fromkeys(("p", "i", "d", "filter", "gain"), SCALAR_SCHEMA)
        kinds |= dict.fromkeys(("numerator", "denominator"), scalars) | dict.fromkeys(("zeros", "poles"), roots)
        kinds |= {name: {"anyOf": [SCALAR_SCHEMA, rows]} for name in "ABCD"}
        law: Schema = {"type": "object", "properties": kinds, "additionalProperties": False, "minProperties": 1}
        return {"anyOf": [SCALAR_SCHEMA, law], "description": self.description}

    @property
    def accepted(self) -> str:
        return f"Scalar | {full_name(ControlLaw)} | GivenTransferFunction | GivenStateSpace | Entries"


def law_expressions(law: ControlLaw, power: int) -> tuple[tuple[EntryPath, Expression, str], ...]:
    """Path, expression and dimension of every coefficient of a control law on the motion s^power theta.

    The dimension is empty where the form of the law leaves it open.
    """
    by_power = {0: "stiffness", 1: "damping", 2: "inertia"}
    if law.form == GAIN:
        return (((), law.entries[0][1], by_power[power]),)
    if law.form == PID:
        # The motion is s^power theta: an integral takes a power of s, a derivative adds one.
        kinds = {"p": power, "i": power - 1, "d": power + 1}
        terms = (
            (name, expression, "time" if name == "filter" else by_power.get(kinds[name], ""))
            for name, expression in law.entries
        )
        return tuple(((name,), expression, dimension) for name, expression, dimension in terms)
    return tuple(((name, *path), expression, "") for name, entry in law.entries for path, expression in _leaves(entry))


def _leaves(entry: Any) -> list[tuple[EntryPath, Expression]]:
    if not isinstance(entry, tuple):
        return [((), entry)]
    return [((place, *path), expression) for place, part in enumerate(entry) for path, expression in _leaves(part)]


def _form(raw: Mapping[str, Any]) -> str:
    names = {str(name) for name in raw}
    for form, known in _FORMS.items():
        if names and names <= known:
            return form
    every = set().union(*_FORMS.values())
    for name in raw:
        if str(name) not in every:
            text = f'"{name}" is not an entry of a control law'
            raise EntryError(unfit_word(text, str(name), every, (name,), f"give {_WAYS}", on_key=True))
    raise EntryError(
        f"{', '.join(sorted(names)) or 'nothing'} cannot be combined to a control law; give {_WAYS}",
        kind="contradicting-entries",
    )


def _at(key: str | int, read: Any, raw: object) -> Any:
    try:
        return read(raw)
    except EntryError as error:
        raise EntryError([fault.under(key) for fault in error.faults]) from None


def _scalar(raw: object) -> Expression:
    value = raw if isinstance(raw, Expression) else read_scalar(raw)
    if isinstance(value, Number) and not abs(value.value) < _LARGEST_COEFFICIENT:
        raise EntryError(
            f"{raw!r} is too large for a coefficient of a law; give a number below 1e40", kind="not-finite"
        )
    return value


def _listed(raw: object) -> list[Any]:
    raw = raw.tolist() if hasattr(raw, "tolist") else raw
    if isinstance(raw, str) or not isinstance(raw, Sequence):
        remedy = Remedy(BRACKET) if isinstance(raw, str) else None
        raise EntryError(
            Fault(f"expected a list of numbers or expressions, {got(raw)}", remedy=remedy, kind="wrong-form")
        )
    if len(raw) > _MOST_COEFFICIENTS:
        raise EntryError(f"{len(raw)} values; a law has at most {_MOST_COEFFICIENTS}", kind="too-large")
    return list(raw)


def _row(raw: object) -> tuple[Any, ...]:
    return tuple(
        _at(place, _root if isinstance(cell, list | tuple) else _scalar, cell)
        for place, cell in enumerate(_listed(raw))
    )


def _root(raw: Sequence[object]) -> tuple[Expression, ...]:
    if len(raw) != 2:
        raise EntryError(f"expected a real number, or [re, im] for a complex pair, {got(raw)}", kind="not-a-number")
    return tuple(_at(place, _scalar, part) for place, part in enumerate(raw))


def _matrices(raw: Mapping[str, Any]) -> tuple[tuple[str, Any], ...]:
    """State-space matrices A (n, n), B (n,), C (n,) and D as entries by name, from lists of any depth."""
    A = tuple(_at("A", lambda row: tuple(map(_scalar, _listed(row))), row) for row in _listed(raw["A"]))
    B, C, D = (_flat(name, raw.get(name, 0)) for name in "BCD")
    if not A or any(len(row) != len(A) for row in A) or len(B) != len(A) or len(C) != len(A) or len(D) != 1:
        raise EntryError(
            "a law senses one motion and makes one torque: A is n x n, B n x 1, C 1 x n and D one number",
            kind="wrong-count",
        )
    return (("A", A), ("B", B), ("C", C), ("D", D[0]))


def _flat(name: str, raw: object) -> tuple[Expression, ...]:
    raw = raw.tolist() if hasattr(raw, "tolist") else raw
    if not isinstance(raw, list | tuple):
        return (_at(name, _scalar, raw),)
    return tuple(
        _at(name, _scalar, cell) for part in raw for cell in (part if isinstance(part, list | tuple) else [part])
    )


def _require_proper_entries(law: ControlLaw) -> None:
    given = dict(law.entries)
    for name in ("numerator", "denominator"):
        if law.form == POLYNOMIALS and not given[name]:
            raise EntryError(
                "expected at least one coefficient, the highest power of s first", (name,), kind="missing-entry"
            )
        if law.form == POLYNOMIALS:
            for place, coefficient in enumerate(given[name]):
                if isinstance(coefficient, tuple):
                    raise EntryError("a coefficient is a number or an expression", (name, place), kind="wrong-form")
    if law.form == POLYNOMIALS and all(coefficient == Number(0) for coefficient in given["denominator"]):
        raise EntryError("the denominator is zero", ("denominator",), kind="out-of-range")


def _plain(entry: Any) -> Any:
    return [_plain(part) for part in entry] if isinstance(entry, tuple) else plain_scalar(entry)


def _from_control(raw: object) -> Any:
    """Entries of a control law from a transfer function or state space of python-control or scipy.

    Other objects unchanged.
    """
    if getattr(raw, "dt", None) not in (None, 0) and not isinstance(raw, Mapping):
        raise EntryError(
            "a law is continuous in time; this one has a sampling time; convert it first", kind="wrong-form"
        )
    if all(hasattr(raw, name) for name in "ABCD"):
        return {name: getattr(raw, name) for name in "ABCD"}
    if hasattr(raw, "num") and hasattr(raw, "den"):
        above, below = ((_only(part)) for part in (raw.num, raw.den))
        return {"numerator": above, "denominator": below}
    return raw


def _only(part: Any) -> list[float]:
    """Coefficients of a single transfer function, from the 1 x 1 matrix of python-control."""
    if getattr(part, "ndim", 1) == 2 or isinstance(part, list | tuple):
        if len(part) != 1 or len(part[0]) != 1:
            raise EntryError("a law senses one motion and makes one torque; this one has several", kind="wrong-form")
        part = part[0][0]
    return [float(value) for value in part]
