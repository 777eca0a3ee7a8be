"""Damaged model files: whatever is wrong, a ModelError with places comes out, or a drivetrain, and nothing else."""

import contextlib
import random
import re

import pytest

from torsionnet.errors import ModelError
from torsionnet.files import dump, library_models, loads
from torsionnet.files.decoding import decode
from torsionnet.files.reader import read_text

NAMES = ("amt_rig", "six_cylinder_diesel", "planetary_set", "drill_string")  # configurations, tables of many shapes
TEXTS = [library_models()[name].read_text(encoding="utf-8") for name in NAMES]
TOKEN = re.compile(r"[A-Za-z_0-9.]+|[^\sA-Za-z_0-9.]")
SNIPPETS = [
    "{", "}", "[", "]", ":", ": ", ",", "#", "&a ", "*a", "!x ", "|", ">", "- ", "? ", "%", "@", "`", "'", '"', "\\", "\t", "\r", "\n",
    "\n---\n", "...", "<<: ", "~", "null", "true", "no", "3:1", "13,3", "1e999", ".nan", "-.inf", "-1", "0", "ground", "omega", "lambda",
    "k**k", "1/0", "2 k_1", "sqrt(-1)", "9**9**9", "0x1F", "017", "\0", "\x1b", "\u2028", "\ufeff", "\U0001f600", "é", "°", "kg*m^2", "rpm",
    "{type: lock, node: motor}", "[motor, ground]", "configurations: {a: {b: {c: {d: 1}}}}", "x" * 300, "(" * 50, "[" * 50, "1" * 500,
]  # fmt: skip


def cut(text, chance):
    return text[: chance.randrange(len(text))]


def drop_characters(text, chance):
    start = chance.randrange(len(text))
    return text[:start] + text[start + chance.randint(1, 8) :]


def insert(text, chance):
    place = chance.randrange(len(text))
    return text[:place] + chance.choice(SNIPPETS) + text[place:]


def replace_token(text, chance):
    tokens = list(TOKEN.finditer(text))
    old = chance.choice(tokens)
    new = chance.choice([chance.choice(tokens)[0], chance.choice(SNIPPETS)])
    return text[: old.start()] + new + text[old.end() :]


def change_lines(text, chance):
    lines = text.splitlines(keepends=True)
    if not lines:
        return text
    first, second = chance.randrange(len(lines)), chance.randrange(len(lines))
    what = chance.choice(["delete", "duplicate", "swap", "indent", "dedent"])
    if what == "delete":
        del lines[first]
    elif what == "duplicate":
        lines.insert(second, lines[first])
    elif what == "swap":
        lines[first], lines[second] = lines[second], lines[first]
    else:
        lines[first] = " " + lines[first] if what == "indent" else lines[first].lstrip()
    return "".join(lines)


MUTATIONS = (cut, drop_characters, insert, replace_token, change_lines, replace_token, change_lines)


def mutant(seed):
    chance = random.Random(seed)
    text = chance.choice(TEXTS)
    for _ in range(chance.randint(1, 4)):
        if len(TOKEN.findall(text)) > 1:
            text = chance.choice(MUTATIONS)(text, chance)
    return text


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


@pytest.mark.parametrize("block", range(8))
def test_mutants(block):
    for seed in range(50 * block, 50 * (block + 1)):
        assert_well_behaved(mutant(seed))


@pytest.mark.slow
@pytest.mark.parametrize("block", range(10))
def test_many_mutants(block):
    for seed in range(1000 + 500 * block, 1500 + 500 * block):
        assert_well_behaved(mutant(seed))


def test_mutated_bytes():
    for seed in range(200):
        chance = random.Random(seed)
        raw = bytearray(chance.choice(TEXTS).encode())
        for _ in range(chance.randint(1, 3)):
            raw[chance.randrange(len(raw))] = chance.randrange(256)
        with contextlib.suppress(ModelError):
            text = decode(bytes(raw), "mutant.yaml")
            assert_well_behaved(text)
