"""Draw plants, ask the package, compare."""

from __future__ import annotations

import math
import random
import warnings
from collections import Counter
from collections.abc import Callable, Iterable
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from flint import acb, arb, ctx

import torsionnet as tn
from plain.equations import Dense
from plain.questions import QUESTIONS
from plain.trains import Plant, plant
from torsionnet.linear.sensitivity.parametric import parametric_response
from torsionnet.model.files.writer import flat_text

BITS = 300
TOLERANCE = 1e-9
NOTHING = 1e-50
"""Smaller numbers are what the digits leave of zero."""

REFUSED = (
    "derivatives are not worked out",
    "held rigidly",
    "is locked in this configuration",
    "cannot turn, there is no ratio",
    "a torque there does nothing",
)
"""Questions that have no answer, as it is documented."""


@dataclass
class Findings:
    """What was compared, and what did not agree."""

    drawn: Counter[str] = field(default_factory=Counter)
    compared: Counter[str] = field(default_factory=Counter)
    worst: dict[str, float] = field(default_factory=dict)
    wrong: list[str] = field(default_factory=list)

    def compare(self, seed: str, what: str, found: complex, exact: complex, tolerance: float = TOLERANCE) -> None:
        self.compared[what] += 1
        size = abs(exact) if abs(exact) > NOTHING else 0.0
        error = abs(found - exact) / size if size else abs(found)
        self.worst[what] = max(self.worst.get(what, 0.0), error if error < tolerance else 0.0)
        if not error <= tolerance:
            self.wrong.append(f"{seed} {what}: {found:.12g} instead of {exact:.12g} ({error:.1e})")


def compare(seed: str, findings: Findings) -> None:
    drawn = plant(seed)
    findings.drawn.update(one.kind for one in drawn.components.values())
    ctx.prec = BITS
    with warnings.catch_warnings(record=True) as heard:
        warnings.simplefilter("always")
        try:
            rig = drawn.model()
            f = _frequencies(seed)
            exact = [Dense(drawn).response(_s(one)) for one in f]
            _responses(seed, drawn, rig, f, exact, findings)
            if drawn.is_rational:
                _poles(seed, drawn, rig, findings)
            _slopes(seed, drawn, rig, f[:3], findings)
            for ask in QUESTIONS:
                _ask(ask, seed, drawn, rig, findings)
        except Exception as error:  # noqa: BLE001  (whatever it is, it is a finding)
            _failed(seed, error, findings)
    for one in heard:
        if not issubclass(one.category, tn.TorsionnetWarning):
            findings.wrong.append(f"{seed} {one.category.__name__}: {one.message}")


def _ask(question: Any, seed: str, drawn: Plant, rig: tn.Drivetrain, findings: Findings) -> None:
    try:
        for what, found, exact, tolerance in question(drawn, rig, random.Random(f"{question.__name__} {seed}")):
            findings.compare(seed, what, found, exact, tolerance)
    except Exception as error:  # noqa: BLE001  (whatever it is, it is a finding)
        _failed(f"{seed} {question.__name__}", error, findings)


def _failed(seed: str, error: Exception, findings: Findings) -> None:
    if isinstance(error, tn.TorsionnetError) and any(words in str(error) for words in REFUSED):
        findings.compared["refused"] += 1
    else:
        findings.wrong.append(f"{seed} {type(error).__name__}: {str(error)[:500]}")


def _frequencies(seed: str) -> list[float]:
    chance = random.Random(f"frequencies {seed}")
    return [10 ** chance.uniform(0.05, 2.59) for _ in range(6)]


def _s(f: float) -> acb:
    return acb(0, 2 * arb.pi() * arb(f))


def _complex(value: acb) -> complex:
    return complex(float(value.real.mid()), float(value.imag.mid()))


def _responses(seed: str, drawn: Plant, rig: tn.Drivetrain, f: list[float], exact: list, findings: Findings) -> None:
    for name, model in (("response", rig), ("flat response", tn.loads(flat_text(rig.definition)))):
        found = model.frequency_response(list(drawn.outputs), list(drawn.inputs), sorted(f)).values
        for place, at in enumerate(np.argsort(f)):
            for row in range(len(drawn.outputs)):
                for column in range(len(drawn.inputs)):
                    right = _complex(exact[at][row][column])
                    what = f"{name} {list(drawn.outputs.values())[row][0]}"
                    findings.compare(seed, what, found[place, row, column], right)
        if "use" not in drawn.data:
            break


def _slopes(seed: str, drawn: Plant, rig: tn.Drivetrain, f: list[float], findings: Findings) -> None:
    """Derivatives to some parameters, by a step of 1e-30 in hundreds of digits."""
    chance = random.Random(f"slopes {seed}")
    free = [name for name in drawn.parameters if name in rig.parameters]
    names = chance.sample(free, min(3, len(free)))
    if not names:
        return
    output, source = chance.choice(list(drawn.outputs)), chance.choice(list(drawn.inputs))
    row, column = list(drawn.outputs).index(output), list(drawn.inputs).index(source)
    function = parametric_response(rig, output, source, np.array(sorted(f)), names)
    found = function.evaluation([drawn.parameters[name] for name in names])
    values, slopes = found.values, found.jacobian
    for index, name in enumerate(names):
        step = arb(drawn.parameters[name]) * arb("1e-30")
        for place, one in enumerate(sorted(f)):
            up, down = (
                Dense(drawn, {name: drawn.parameters[name] + sign * step}).response(_s(one))[row][column]
                for sign in (1, -1)
            )
            right = _complex((up - down) / (2 * step) * drawn.parameters[name])
            size = abs(values[place].item())
            got = slopes[place, ..., index].item() * drawn.parameters[name]
            if max(size, abs(right)) < NOTHING:
                continue
            # A derivative that is nothing beside the value is compared with that.
            findings.compare(seed, "slope", 1 + (got - right) / max(size, abs(right)), 1.0, 1e-8)


def _poles(seed: str, drawn: Plant, rig: tn.Drivetrain, findings: Findings) -> None:
    """Every pole by Newton's method on the determinant, and their number by its growth from zero to infinity."""
    dense = Dense(drawn)
    found = [one for one in rig.modes().eigenvalues if one != 0]
    own = [_complex(root) for one in drawn.components.values() for root in one.roots(dense.value)]
    for pole in found:
        if any(abs(pole - root) < 1e-6 * abs(pole) for root in own):
            continue  # of a controller whose torque moves nothing: no zero of the determinant
        right = _newton(dense, pole)
        findings.compare(seed, "pole", pole, right, 1e-7)
    number = sum(2 if one.imag > 0 else 1 for one in found)
    ctx.prec = 4000
    own = [root for one in drawn.components.values() for root in one.roots(dense.value)]
    dense = Dense(drawn)
    high, low = (_degree(dense, exponent) for exponent in (60, -60))
    expected = high - low + sum(1 for root in own if not root == 0)  # noqa: SIM201
    ctx.prec = BITS
    findings.compare(seed, "number of poles", number, expected)


def _degree(dense: Dense, exponent: int) -> int:
    """The power of s that the determinant grows with."""
    s = acb(arb(10) ** exponent, arb(10) ** exponent / 3)
    ratio = abs(dense.determinant(s * 2)) / abs(dense.determinant(s))
    return round(math.log2(float(ratio.mid())))


def _newton(dense: Dense, start: complex) -> complex:
    s = acb(start.real, start.imag)
    step = acb(arb("1e-40")) * abs(s)
    for _ in range(6):
        up, down = dense.determinant(s + step), dense.determinant(s - step)
        s -= step * (up + down) / (up - down)
        s = acb(s.real.mid(), s.imag.mid())
    return _complex(s)


def run(seeds: Iterable[str], told: Callable[[str], None] = lambda _: None) -> Findings:
    findings = Findings()
    for seed in seeds:
        before = len(findings.wrong)
        compare(seed, findings)
        for text in findings.wrong[before:]:
            told(text)
    return findings
