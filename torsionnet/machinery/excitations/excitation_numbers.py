"""Numbers in the entries of excitations, named by their place, so that fits can vary them.

``propeller.blade_orders.1.share`` is a number of the excitation ``propeller``; ``engine.misfire_share.4`` one that the
model may leave out, which then has the value without effect.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from math import inf
from typing import Any

from torsionnet.base.entries.composite import Named, Nested
from torsionnet.base.entries.declared import Declared
from torsionnet.base.entries.scalars import Value
from torsionnet.base.entries.spec import EntryError, Spec
from torsionnet.base.errors import UsageError, did_you_mean
from torsionnet.base.units import expected_unit
from torsionnet.machinery.excitations.gas_torque import BY_ORDER, HarmonicTables
from torsionnet.machinery.excitations.harmonic_torque import TableByOrder
from torsionnet.machinery.excitations.order_excitation import OrderExcitation

NEUTRAL_VALUES = {"misfire_share": 0.0, "factors": 1.0}
"""Value without effect of a cylinder that a table of an engine does not name, by entry."""
LARGEST_BY_ENTRY = {"misfire_share": 1.0}
"""Largest value of numbers in a table by entry, where no specification says it: a whole misfire."""


@dataclass(frozen=True)
class ExcitationNumber:
    """Number in an entry of an excitation: its place, value and bounds in SI, and dimension.

    Attributes
    ----------
    name : str
        As a fit names it: ``engine.misfire_share.4``.
    excitation : str
    path : tuple
        Entries and keys of tables from the excitation to the number, in stored form.
    value : float
        SI.
    dimension : str
        A key of the units: ``"1"``, ``"angle"``, ``"torque"``, ...
    bounds : tuple of float
        Lowest and highest value that the entry allows, SI.
    absent : Declared, optional
        What stands for a row that the model leaves out.
    """

    name: str
    excitation: str
    path: tuple[Any, ...]
    value: float
    dimension: str
    bounds: tuple[float, float]
    absent: Declared | None = None

    @property
    def unit(self) -> str:
        """SI unit of the number, empty for a plain number."""
        unit = expected_unit(self.dimension)
        return "" if unit == "1" else unit

    @property
    def is_phase(self) -> bool:
        """Whether the number is an angle, which orders without phases do not show."""
        return self.dimension == "angle"


def excitation_number(excitations: Mapping[str, OrderExcitation], name: str) -> ExcitationNumber | None:
    """Number of an excitation (SI) that a dotted name means, or None if it begins with the name of no excitation.

    Raises
    ------
    UsageError
        The excitation has no such number.

    Examples
    --------
    >>> import torsionnet as tn
    >>> excitations = tn.load("engine_generator_set").definition.excitations
    >>> excitation_number(excitations, "engine.misfire_share.4").value
    0.0
    >>> excitation_number(excitations, "engine.gas.correction.0.5.real").path
    ('gas', 'correction', 0.5, 'real')
    """
    owner = max((excitation for excitation in excitations if name.startswith(f"{excitation}.")), key=len, default=None)
    if owner is None:
        return None
    tokens = name.removeprefix(f"{owner}.").split(".")
    located = _of_declared(excitations[owner], tokens)
    cylinders = getattr(excitations[owner], "cylinders", {})
    if located is not None and tokens[0] in NEUTRAL_VALUES and tokens[-1] not in cylinders:
        raise UsageError(f"{owner} has no cylinder {tokens[-1]}; there are {', '.join(cylinders)}", kind="unknown-name")
    if located is None:
        tables = [f"{owner}.{entry}.{number}" for entry in NEUTRAL_VALUES for number in cylinders]
        known = [*tables, *(f"{owner}.{each}" for each in _names(excitations[owner]))]
        hint = did_you_mean(name, known) or (f"; it has {', '.join(known)}" if known else "")
        raise UsageError(f'{owner} has no number "{".".join(tokens)}" to vary{hint}', kind="unknown-name")
    path, value, spec, absent = located
    high = LARGEST_BY_ENTRY.get(str(path[0]), inf if spec.below is None else spec.below)
    bounds = (-inf if spec.lower is None else spec.lower, high)
    return ExcitationNumber(name, owner, path, value, spec.dimension, bounds, absent)


def numbers_by_name(name: str, excitation: OrderExcitation) -> Iterator[ExcitationNumber]:
    """Numbers (SI) in the entries of an excitation that are given, in the order of its entries."""
    for number in _names(excitation):
        known = excitation_number({name: excitation}, f"{name}.{number}")
        if known is not None:
            yield known


def with_number(excitation: OrderExcitation, number: ExcitationNumber, value: float) -> OrderExcitation:
    """Copy of an excitation in which one number has another value in SI, without any check.

    A search may pass values that no file may hold, as a share a little below 0.
    """
    changed: OrderExcitation = _put(excitation, number.path, value, number.absent)
    return changed


def with_numbers(excitations: Mapping[str, OrderExcitation], values: Mapping[str, float]) -> dict[str, OrderExcitation]:
    """Excitations by name with other numbers, in SI, by their dotted names; unchecked as :func:`with_number`.

    Raises
    ------
    UsageError
        No excitation has such a number.
    """
    changed = dict(excitations)
    for name, value in values.items():
        number = excitation_number(changed, name)
        if number is None:
            raise UsageError(
                f'no excitation has a number "{name}"{did_you_mean(name.partition(".")[0], changed)}',
                kind="unknown-entry",
            )
        changed[number.excitation] = with_number(changed[number.excitation], number, float(value))
    return changed


Found = tuple[tuple[Any, ...], float, Value, "Declared | None"]


def _of_declared(owner: Declared, tokens: Sequence[str]) -> Found | None:
    spec = dict(owner.specs()).get(tokens[0])
    if spec is None:
        return None
    located = _within(spec, getattr(owner, tokens[0]), tokens[1:], tokens[0])
    return None if located is None else ((tokens[0], *located[0]), *located[1:])


def _within(spec: Spec[Any], value: Any, tokens: Sequence[str], entry: str) -> Found | None:
    if isinstance(spec, Value):
        return None if tokens or value is None else ((), float(value), spec, None)
    if not tokens:
        return None
    if isinstance(spec, HarmonicTables):
        (key, table), *others = (value or {None: {}}).items()
        located = None if others else _within(BY_ORDER, table, tokens, entry)
        return None if located is None else ((key, *located[0]), *located[1:])
    if isinstance(spec, TableByOrder):
        return _of_table(spec, value or {}, tokens)
    if isinstance(spec, Named) and isinstance(spec.of, Value):
        known = (value or {}).get(tokens[0], NEUTRAL_VALUES.get(entry))
        allowed = len(tokens) == 1 and known is not None and (spec.refused is None or not spec.refused(tokens[0]))
        return ((tokens[0],), float(known), spec.of, None) if allowed and known is not None else None
    if isinstance(spec, Named) and tokens[0] in (value or {}):
        located = _within(spec.of, value[tokens[0]], tokens[1:], entry)
        return None if located is None else ((tokens[0], *located[0]), *located[1:])
    return _of_declared(value, tokens) if isinstance(spec, Nested) and isinstance(value, Declared) else None


def _of_table(spec: TableByOrder[Any], table: Mapping[float, Declared], tokens: Sequence[str]) -> Found | None:
    """Number in a table by order, whose keys may hold a point themselves: 0.5.real."""
    # The longest key first: 0.5.real is the real part of order 0.5.
    for count in range(len(tokens) - 1, 0, -1):
        try:
            key = spec.key.coerce(".".join(tokens[:count]))
        except EntryError:
            continue
        cls = spec.of.of()
        row = table.get(key)
        absent = None if row is not None or cls.required() else cls()
        if row is None and (absent is None or absent.contradictions()):
            continue
        located = _of_declared(row or absent, tokens[count:])  # type: ignore[arg-type]
        if located is not None:
            return (key, *located[0]), located[1], located[2], absent or located[3]
    return None


def _put(owner: Any, path: Sequence[Any], value: float, absent: Declared | None) -> Any:
    if not path:
        return value
    if owner is None or isinstance(owner, Mapping):
        known = (owner or {}).get(path[0], absent)
        return {**(owner or {}), path[0]: _put(known, path[1:], value, absent)}
    return owner.unchecked(**{path[0]: _put(getattr(owner, path[0]), path[1:], value, absent)})


def _names(owner: Declared) -> Iterator[str]:
    """Names of the numbers in the entries of an object that are given."""
    for entry, spec in owner.specs():
        for name in _names_within(spec, getattr(owner, entry)):
            yield f"{entry}.{name}" if name else entry


def _names_within(spec: Spec[Any], value: Any) -> Iterator[str]:
    if isinstance(spec, Value):
        yield from [""] if value is not None else []
    elif isinstance(spec, HarmonicTables):
        yield from _names_within(BY_ORDER, next(iter(value.values()))) if value and len(value) == 1 else []
    elif isinstance(spec, TableByOrder | Named):
        for key, row in (value or {}).items():
            label = f"{key:g}" if isinstance(key, float) else str(key)
            yield from (f"{label}.{name}".rstrip(".") for name in _names_within(spec.of, row))
    elif isinstance(spec, Nested) and isinstance(value, Declared):
        yield from _names(value)
