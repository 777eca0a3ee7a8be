"""Damaged model files: whatever is wrong, a ModelError with places comes out, or a drivetrain, and nothing else."""

import contextlib
import random

import pytest
from fuzz.mutating import mutated

from torsionnet.base.errors import ModelError
from torsionnet.drivetrain import loads
from torsionnet.model.files.library import decode, library_models
from torsionnet.model.files.reader import read_text
from torsionnet.model.files.writer import dump

NAMES = ("amt_rig", "six_cylinder_diesel", "planetary_set", "drill_string")  # configurations, tables of many shapes
TEXTS = [library_models()[name].read_text(encoding="utf-8") for name in NAMES]


def mutant(seed):
    chance = random.Random(seed)
    return mutated(chance.choice(TEXTS), chance)


def assert_well_behaved(text):
    """A drivetrain that survives being written, or a ModelError with places."""
    definition, faults = read_text(text, "mutant.yaml")
    for fault in faults:
        assert fault.position.line >= 1
        assert fault.position.column >= 1
        assert fault.message.isprintable()
        assert str(fault)
    if definition is not None:
        assert loads(dump(definition)).definition.to_data() == definition.to_data()
        return
    with pytest.raises(ModelError) as caught:
        loads(text, "mutant.yaml")
    assert caught.value.faults


@pytest.mark.few(1)
@pytest.mark.parametrize("block", range(8))
def test_mutants(block):
    for seed in range(50 * block, 50 * (block + 1)):
        assert_well_behaved(mutant(seed))


@pytest.mark.nightly
@pytest.mark.parametrize("block", range(10))
def test_many_mutants(block):
    for seed in range(1000 + 500 * block, 1500 + 500 * block):
        assert_well_behaved(mutant(seed))


@pytest.mark.slow
def test_mutated_bytes():
    for seed in range(200):
        chance = random.Random(seed)
        raw = bytearray(chance.choice(TEXTS).encode())
        for _ in range(chance.randint(1, 3)):
            raw[chance.randrange(len(raw))] = chance.randrange(256)
        with contextlib.suppress(ModelError):
            text = decode(bytes(raw), "mutant.yaml")
            assert_well_behaved(text)
