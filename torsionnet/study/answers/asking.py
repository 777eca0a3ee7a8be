"""What several answers ask of a study before they begin: its quantities, units, limits, and what does not fit."""

from __future__ import annotations

from collections.abc import Iterator

from torsionnet.core.errors import Fault
from torsionnet.model.checks.units_in_use import parameter_units
from torsionnet.study.answer import AskedStudy
from torsionnet.study.quantity import QuantityForm
from torsionnet.study.quantity_value import as_written


def case_label(configuration: str) -> str:
    """A configuration as it is told in tables."""
    return configuration or "as given"


def measure_of(study: AskedStudy, name: str) -> QuantityForm:
    """Unit and points of a quantity, which are those in all configurations."""
    return study.quantities[name].measured(study.model_in(study.configurations[0]), study.quantities)


def units_of(study: AskedStudy) -> dict[str, str]:
    """Units of the parameters that vary."""
    known = parameter_units(study.model.definition)
    return {name: known.get(name, "") for name in study.space.names}


def chosen_quantities(study: AskedStudy, names: tuple[str, ...]) -> tuple[str, ...]:
    """Those named, by default all that are single numbers."""
    return names or tuple(name for name in study.quantities if not measure_of(study, name).is_curve)


def limit_words(study: AskedStudy, name: str) -> str:
    """What the limit of a quantity does not allow, ``peak above 20 N*m``, in the units in which it was written."""
    limit, unit = study.limits[name], measure_of(study, name).unit
    sides = [(word, value) for word, value in (("above", limit.below), ("below", limit.above)) if value is not None]
    return f"{name} " + " or ".join(f"{word} {as_written(value, unit)}" for word, value in sides)


def quantity_faults(study: AskedStudy, names: tuple[str, ...], key: str) -> Iterator[Fault]:
    """Names of curves, which are not single numbers."""
    for place, name in enumerate(names):
        path = (key, place) if key == "quantities" else (key,)
        if name in study.quantities and measure_of(study, name).is_curve:
            yield Fault(f"{name} is a curve; name a quantity that is a single number, as its peak", path)
    if not names and not chosen_quantities(study, ()):
        yield Fault("none of the quantities is a single number, as a frequency or a peak", on_key=True)


def limit_faults(study: AskedStudy, names: tuple[str, ...]) -> Iterator[Fault]:
    """Limits that are not there, or are on curves."""
    if not study.limits:
        yield Fault("no quantity has a limit; give the study limits: {QUANTITY: {below: VALUE}}", on_key=True)
    for name in study.limits:
        if name in (names or study.limits) and name in study.quantities and measure_of(study, name).is_curve:
            yield Fault(f"{name} is a curve; limit a quantity that is a single number, as its peak", on_key=True)


def distribution_faults(study: AskedStudy) -> Iterator[Fault]:
    """Nothing is drawn at random."""
    if not study.space.random_names:
        yield Fault("no parameter has a distribution; this answer draws variants at random", on_key=True)
