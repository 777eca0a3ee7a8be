"""What is asked of a model: readings at every place, against inputs and against other readings."""

from __future__ import annotations

import random
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction

from oracle.answers import Answer, Question
from oracle.description import GROUND, SINGLE, Model, Part, Reading
from oracle.solution import Mechanics

PASSES_TORQUE_TO_GROUND = ("spring", "damper", "hysteretic_spring", "tabulated_spring", "rigid_coupling")
MOST_OUTPUTS = 14


@dataclass(frozen=True)
class Asked:
    """A question with the words in which the package is asked it."""

    question: Question
    outputs: tuple[str, ...]
    inputs: tuple[str, ...]
    excitations: tuple[str, ...] = ()

    def __str__(self) -> str:
        return f"{self.outputs} / {self.inputs}" + (f", excitation {self.excitations}" if self.excitations else "")

    @property
    def excited(self) -> dict[str, list[str]]:
        """The argument ``excitation`` where one is needed."""
        return {"driven_by": list(self.excitations)} if self.excitations else {}

    def only(self, output: int) -> Asked:
        """The same for one output."""
        question = replace(self.question, outputs=self.question.outputs[output : output + 1])
        return replace(self, question=question, outputs=self.outputs[output : output + 1])

    def words(self, output: int, into: int, frequency: float) -> str:
        """One transfer function at one frequency."""
        text = f"{self.outputs[output]} / {self.inputs[into]} at {frequency!r} Hz"
        return f"{text}, inputs {self.inputs}, excitation {self.excitations}" if self.excitations else text


def readings_of(model: Model) -> list[Reading]:
    """Every sensor whose reading the documentation defines."""
    found = [Reading(quantity, node) for node in model.nodes for quantity in ("angle", "velocity", "acceleration")]
    for part in model.parts:
        if part.kind not in SINGLE and not (part.kind == "differential" and part.values.get("locked")):
            found.append(Reading("twist", part.name))
        found += [Reading("torque", part.name, port) for port in torque_ports(part)]
    return found


def torque_ports(part: Part) -> list[str]:
    """What an element with more than two ends hands over to ground is asked of a lock instead."""
    every = part.kind in PASSES_TORQUE_TO_GROUND
    return [port for port, node in part.ports.items() if every or node != GROUND]


def words(reading: Reading, mechanics: Mechanics, chance: random.Random) -> str:
    """As the package is asked: the port by its name, its node, or not at all where it defines the sign."""
    if reading.quantity != "torque":
        return reading.of if reading.quantity == "angle" and chance.random() < 0.3 else str(reading)
    ports = mechanics.parts[reading.of].ports
    if reading.port == next(iter(ports)) and chance.random() < 0.5:
        return f"torque({reading.of})"
    return f"torque({reading.of}, {ports[reading.port] if chance.random() < 0.3 else reading.port})"


def sample(readings: Sequence[Reading], count: int, chance: random.Random) -> tuple[Reading, ...]:
    """Half of them torques, as far as there are."""
    torques = [reading for reading in readings if reading.quantity == "torque"]
    others = [reading for reading in readings if reading.quantity != "torque"]
    chosen = chance.sample(torques, min(len(torques), count // 2))
    return tuple(chosen + chance.sample(others, min(len(others), count - len(chosen))))


def response_questions(mechanics: Mechanics, chance: random.Random) -> Asked:
    """Readings against every declared input and against a torque on some other node."""
    model = mechanics.model
    known = [reading for reading in readings_of(model) if mechanics.is_determinate(reading)]
    driven = dict(model.inputs)
    free = [node for node in model.nodes if mechanics.motion[node]]
    if free:
        node = chance.choice(free)
        driven.setdefault(node, ("torque", node))
    outputs = sample(known, MOST_OUTPUTS, chance)
    return asked(mechanics, outputs, (), driven, chance)


def measured_questions(mechanics: Mechanics, chance: random.Random) -> list[Asked]:
    """Readings against one other reading, and against two under two excitations."""
    known = [reading for reading in readings_of(mechanics.model) if mechanics.is_determinate(reading)]
    inputs = dict(mechanics.model.inputs)
    found = []
    for number in (1, 1, 2):
        if number <= len(inputs):
            names = chance.sample(list(inputs), number)
            chosen = {name: inputs[name] for name in names}
            measured = chosen_inputs(mechanics, known, chosen, chance)
            if measured:
                found.append(asked(mechanics, sample(known, 6, chance), measured, chosen, chance))
    return found


def refused_questions(mechanics: Mechanics, chance: random.Random) -> list[tuple[str, str]]:
    """One torque that equilibrium does not determine, against an input."""
    shared = [str(reading) for reading in readings_of(mechanics.model) if not mechanics.is_determinate(reading)]
    return [(chance.choice(shared), next(iter(mechanics.model.inputs)))] if shared else []


def chosen_inputs(
    mechanics: Mechanics, known: Sequence[Reading], driven: Mapping[str, tuple[str, str]], chance: random.Random
) -> tuple[Reading, ...]:
    """As many readings as excitations; those that never move are mostly, not always, passed over."""
    for _ in range(8):
        measured = sample(known, 3 * len(driven), chance)
        measured = tuple(chance.sample(measured, min(len(driven), len(measured))))
        if len(measured) == len(driven):
            zeros = Answer(mechanics, Question(measured, tuple(driven.values()))).zeros
            if not any(all(row) for row in zeros) or chance.random() < 0.05:
                return measured
    return ()


def symbolic_questions(mechanics: Mechanics, chance: random.Random) -> list[Asked]:
    """Three outputs against one input, two against one other reading."""
    known = [reading for reading in readings_of(mechanics.model) if mechanics.is_determinate(reading)]
    inputs = mechanics.model.inputs
    name = chance.choice(list(inputs))
    driven = {name: inputs[name]}
    return [
        asked(mechanics, sample(known, 3, chance), (), driven, chance),
        *(
            asked(mechanics, sample(known, 2, chance), measured, driven, chance)
            for measured in [chosen_inputs(mechanics, known, driven, chance)]
            if measured
        ),
    ]


def asked(
    mechanics: Mechanics,
    outputs: Sequence[Reading],
    measured: Sequence[Reading],
    driven: dict[str, tuple[str, str]],
    chance: random.Random,
) -> Asked:
    question = Question(tuple(outputs), tuple(driven.values()), tuple(measured))
    said = tuple(words(reading, mechanics, chance) for reading in outputs)
    into = tuple(str(reading) for reading in measured) or tuple(driven)
    return Asked(question, said, into, tuple(driven) if measured else ())


def frequencies(poles: Sequence[complex], chance: random.Random) -> list[float]:
    """From 1e-4 to 1e4 Hz, some of them near a lightly damped pole but not on it."""
    found = [float(f"{10 ** chance.uniform(-4, 4):.4g}") for _ in range(6)]
    light = [abs(pole) / 6.283185307179586 for pole in poles if pole.imag > 0 and -pole.real < 0.01 * pole.imag]
    for own in chance.sample(light, min(2, len(light))):
        off = chance.choice((1, -1)) * 10 ** chance.uniform(-4, -2)
        found.append(float(Fraction(own * (1 + off)).limit_denominator(10**9)) or own)
    return sorted(f for f in set(found) if 1e-4 <= f <= 1e4)
