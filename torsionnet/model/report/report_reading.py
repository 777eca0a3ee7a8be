"""The ``report:`` section from the plain content of a model file, with every fault."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from torsionnet.core.errors import Fault, Path, UsageError, did_you_mean, unknown_key
from torsionnet.model.elements.fields import FieldError
from torsionnet.model.report.report_plan import Pair, ReportPlan, parse_band
from torsionnet.model.report.sections import SECTIONS

KEYS = ("title", "author", "sections", "transfer_functions", "configurations", "band", "angle", "notes")
ANGLES = ("rad", "deg")
Faults = list[Fault]


def read_outline(raw: Any, path: Path = ("report",)) -> tuple[ReportPlan | None, Faults]:
    """Outline from the ``report:`` section, None if anything in it is wrong, and all faults."""
    if isinstance(raw, ReportPlan):
        return raw, []
    if not isinstance(raw, Mapping):
        return None, [Fault(f"expected the entries {', '.join(KEYS)}, got {raw!r}", path)]
    rest = f"a report has {', '.join(KEYS)}"
    faults = [unknown_key(key, KEYS, (key,), rest) for key in raw if key not in KEYS]
    readers: dict[str, Callable[[Any], tuple[Any, Faults]]] = {
        "title": _text,
        "author": _text,
        "notes": _text,
        "sections": _sections,
        "transfer_functions": _pairs,
        "configurations": _names,
        "band": _band,
        "angle": _angle,
    }
    entries: dict[str, Any] = {}
    for key, read in readers.items():
        if key in raw:
            entries[key], found = read(raw[key])
            faults += [fault.under(key) for fault in found]
    return (None if faults else ReportPlan(**entries)), [fault.under(*path) for fault in faults]


def section_fault(name: Any) -> str:
    """Why this is no section of a report, or nothing."""
    if name in SECTIONS:
        return ""
    text = f'no section is named "{name}"{did_you_mean(str(name), SECTIONS)}; known: {", ".join(SECTIONS)}'
    return text.replace("?; ", "? ")


def _text(raw: Any) -> tuple[str, Faults]:
    return (raw, []) if isinstance(raw, str) else ("", [Fault(f"expected text, got {raw!r}")])


def _names(raw: Any) -> tuple[tuple[str, ...], Faults]:
    if not isinstance(raw, (list, tuple)):
        return (), [Fault(f"expected a list of names, got {raw!r}")]
    faults = [Fault(f"expected a name, got {name!r}", (index,)) for index, name in enumerate(raw) if not _is_name(name)]
    return tuple(map(str, raw)), faults


def _is_name(raw: Any) -> bool:
    return isinstance(raw, (str, int)) and not isinstance(raw, bool)


def _sections(raw: Any) -> tuple[tuple[str, ...], Faults]:
    names, faults = _names(raw)
    faults += [Fault(reason, (index,)) for index, name in enumerate(names) if (reason := section_fault(name))]
    return names, faults


def _pairs(raw: Any) -> tuple[tuple[Pair, ...], Faults]:
    if not isinstance(raw, (list, tuple)):
        return (), [Fault(f"expected a list such as [theta_1/T_T], got {raw!r}")]
    pairs: list[Pair] = []
    faults: Faults = []
    for index, entry in enumerate(raw):
        try:
            pairs.append(_pair(entry))
        except UsageError as error:
            faults.append(Fault(str(error), (index,)))
    return tuple(pairs), faults


def _pair(raw: Any) -> Pair:
    if isinstance(raw, Pair):
        return raw
    if isinstance(raw, str):
        return Pair.parse(raw)
    known = ("output", "input", "excitation")
    if isinstance(raw, Mapping) and {"output", "input"} <= set(raw) <= set(known):
        return Pair(**{str(key): str(value) for key, value in raw.items()})
    msg = f"expected OUTPUT/INPUT, or {{output: ..., input: ..., excitation: ...}}; got {raw!r}"
    raise UsageError(msg)


def _band(raw: Any) -> tuple[tuple[float, float] | None, Faults]:
    try:
        return parse_band(raw), []
    except FieldError as error:
        return None, [error.fault]


def _angle(raw: Any) -> tuple[str, Faults]:
    if raw in ANGLES:
        return str(raw), []
    return "rad", [Fault(f"expected {' or '.join(ANGLES)}, got {raw!r}")]
