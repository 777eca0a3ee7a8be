"""Quantities, units and limits of a study that its answers use, and faults in the entries of answers."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from typing import Any

from torsionnet.base.errors import EntryPath, Fault, unknown_name
from torsionnet.model.checks.parameter_units import parameter_units
from torsionnet.study.answers.answer import AskedStudy
from torsionnet.study.quantities.quantity import QuantityForm
from torsionnet.study.quantities.quantity_limit import as_written

QUANTITY, LIMIT, PARAMETER = "quantity", "limit", "parameter"
VARIED, CONFIGURATION = "varied parameter", "configuration of the study"


def unknown_names(
    naming: Mapping[str, str], entries: Mapping[str, Any], known: Mapping[str, Iterable[str]]
) -> list[Fault]:
    """Faults of the names in an answer's entries that the study does not have, the entries as written or as read.

    Parameters
    ----------
    naming : mapping
        Key of an entry -> what it names, such as :data:`LIMIT`.
    entries : mapping
        Key -> a name, a list of names, or a table by name; any other form has a fault of its own.
    known : mapping
        What is named -> the names that exist.

    Examples
    --------
    >>> faults = unknown_names({"limits": LIMIT}, {"limits": ["peak", "peek"]}, {LIMIT: ["peak", "f_2"]})
    >>> [(fault.path, fault.message) for fault in faults]
    [(('limits', 1), 'no limit is named "peek"; did you mean "peak"? there are peak, f_2')]
    """
    found = []
    for key, what in naming.items():
        there = list(known[what])
        rest = f"there are {', '.join(there)}" if there and what != PARAMETER else ""
        for name, path, on_key in _names(key, entries.get(key)):
            if name not in there:
                found.append(unknown_name(what, name, there, path, on_key=on_key, rest=rest))
    return found


def _names(key: str, value: Any) -> Iterator[tuple[str, EntryPath, bool]]:
    """Yield each name in an entry of an answer with its path, and whether it is a key of a table."""
    if isinstance(value, str):
        yield value, (key,), False
    elif isinstance(value, Mapping):
        yield from ((str(name), (key, name), True) for name in value)
    elif isinstance(value, list | tuple):
        yield from ((name, (key, place), False) for place, name in enumerate(value) if isinstance(name, str))


def case_label(configuration: str) -> str:
    """Name of a configuration in tables, or "as given" for the model as it stands."""
    return configuration or "as given"


def measure_of(study: AskedStudy, name: str) -> QuantityForm:
    """Form of a quantity (SI unit, and points of a curve), the same in all configurations."""
    return study.quantities[name].measured(study.model_in(study.configurations[0]), study.quantities)


def units_of(study: AskedStudy) -> dict[str, str]:
    """SI unit of each varied parameter of a study, by its name."""
    known = parameter_units(study.model.definition)
    return {name: known.get(name, "") for name in study.space.names}


def chosen_quantities(study: AskedStudy, names: tuple[str, ...]) -> tuple[str, ...]:
    """Names of the quantities that an answer uses, those given or else all of the study that are single numbers."""
    return names or tuple(name for name in study.quantities if not measure_of(study, name).is_curve)


def limit_words(study: AskedStudy, name: str) -> str:
    """Words for exceeding a limit, such as ``peak above 20 N*m``, or of a curve ``largest H above 2 rad``.

    Values are in the units in which the limit was written.
    """
    limit, form = study.limits[name], measure_of(study, name)
    sides = (("above", "largest", limit.below), ("below", "smallest", limit.above))
    said = [
        (word, f"{which} {name}", as_written(value, form.unit)) for word, which, value in sides if value is not None
    ]
    if form.is_curve:
        return " or ".join(f"{what} {word} {value}" for word, what, value in said)
    return f"{name} " + " or ".join(f"{word} {value}" for word, _, value in said)


def quantity_faults(study: AskedStudy, names: tuple[str, ...], key: str) -> Iterator[Fault]:
    """Yield a fault for each quantity of an answer that is a curve although the answer needs a single number."""
    for place, name in enumerate(names):
        path = (key, place) if key == "quantities" else (key,)
        if name in study.quantities and measure_of(study, name).is_curve:
            yield Fault(f"{name} is a curve; name a quantity that is a single number, as its peak", path)
    if not names and not chosen_quantities(study, ()):
        yield Fault("none of the quantities is a single number, as a frequency or a peak", on_key=True)


def limit_faults(study: AskedStudy) -> Iterator[Fault]:
    """Yield a fault if a study gives none of its quantities a limit."""
    if not study.limits:
        yield Fault("no quantity has a limit; give the study limits: {QUANTITY: {below: VALUE}}", on_key=True)


def distribution_faults(study: AskedStudy) -> Iterator[Fault]:
    """Yield a fault if a study has no random parameter, for answers that draw variants."""
    if not study.space.random_names:
        yield Fault("no parameter has a distribution; this answer draws variants at random", on_key=True)
