"""Engines with a known angle between their crankshafts, and engines that run alone."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from torsionnet.base.registers import Groups
from torsionnet.machinery.excitations.order_excitation import OrderExcitation


def crankshafts(excitations: Mapping[str, OrderExcitation]) -> list[list[str]]:
    """Names of the engines that share a crankshaft, grouped by crankshaft, in the order of the model.

    Engines that name the same node count their firing angles from the same angle, as the stages of a compressor.
    """
    together: Groups[tuple[str, str]] = Groups()
    for name, one in excitations.items():
        if one.crankshaft:
            together.join(("engine", name), *(("node", node) for node in sorted(one.crankshaft)))
    groups = [{name for kind, name in group if kind == "engine"} for group in together.groups()]
    found = [[name for name in excitations if name in group] for group in groups]
    order = list(excitations)
    return sorted(found, key=lambda group: order.index(group[0]))


def unlocked_engines(acting: Mapping[str, OrderExcitation], declared: Mapping[str, OrderExcitation]) -> dict[str, str]:
    """First engine of the group whose angles to each other are known, by name of each acting engine.

    Empty if all angles are known.

    An engine with a phase is fixed to the first engine of the model, and to others with a phase.
    """
    shafts = crankshafts(declared)
    phased = [shaft for shaft in shafts if any(declared[name].is_phased for name in shaft)]
    fixed = {name for shaft in [*shafts[:1], *phased] for name in shaft}
    classes = [fixed, *(set(shaft) for shaft in shafts if not fixed & set(shaft))]
    found = {}
    for name, one in acting.items():
        if one.crankshaft:
            alike = next(names for names in classes if name in names)
            found[name] = next(other for other in acting if other in alike)
    return found if len(set(found.values())) > 1 else {}


def running_engines_text(excitations: Mapping[str, OrderExcitation]) -> str:
    """Sentence that names the running engines of a model with several; empty with at most one engine."""
    engines = _engines(excitations)
    if len(engines) < 2:
        return ""
    running = [_named(shaft) for shaft in engines if any(excitations[name].enabled for name in shaft)]
    if len(running) == 1:
        return f"{running[0]} runs alone in this condition"
    return f"{' and '.join(running) or 'no engine'} run{'s' * (not running)} in this condition"


def conditions_running_alone(conditions: Iterable[tuple[str, Mapping[str, OrderExcitation]]]) -> dict[str, list[str]]:
    """Names of the conditions in which an engine runs alone, by engine; empty for a model with one engine."""
    known = [(name, excitations, _engines(excitations)) for name, excitations in conditions]
    return {
        _named(engine): [
            name or "the model as written"
            for name, excitations, engines in known
            if [shaft for shaft in engines if any(excitations[one].enabled for one in shaft)] == [engine]
        ]
        for engine in (known[0][2] if known and len(known[0][2]) > 1 else ())
    }


def _engines(excitations: Mapping[str, OrderExcitation]) -> list[list[str]]:
    """Names of the engines, without compressors and pumps, grouped by crankshaft."""
    return [shaft for shaft in crankshafts(excitations) if not all(excitations[name].absorbs for name in shaft)]


def _named(shaft: list[str]) -> str:
    return " with ".join(shaft)
