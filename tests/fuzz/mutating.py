"""Small damages to texts and bytes."""

from __future__ import annotations

import random
import re
from collections.abc import Callable, Sequence

TOKEN = re.compile(r"[A-Za-z_0-9.]+|[^\sA-Za-z_0-9.]")
NUMBERS = (
    "0", "-1", "1e-308", "5e-324", "1e-150", "1e-30", "1e9", "1e15", "1e30", "1e150", "1e300", "1e308", "-1e308", "1e309",
    "2147483648", "0.5", "3", "1e9 Hz", "1e308 rpm", "1e300 N*m/rad", "50 %", "17/61",
)  # fmt: skip
SNIPPETS = (
    "{", "}", "[", "]", ":", ": ", ",", "#", "&a ", "*a", "!x ", "|", ">", "- ", "? ", "%", "@", "`", "'", '"', "\\", "\t", "\r", "\n",
    "\n---\n", "...", "<<: ", "~", "null", "true", "no", "3:1", "13,3", "1e999", ".nan", "-.inf", "-1", "0", "ground", "omega", "lambda",
    "k**k", "1/0", "2 k_1", "sqrt(-1)", "9**9**9", "0x1F", "017", "\0", "\x1b", "\u2028", "\ufeff", "\U0001f600", "é", "°", "kg*m^2", "rpm",
    "{type: lock, node: motor}", "[motor, ground]", "configurations: {a: {b: {c: {d: 1}}}}", "x" * 300, "(" * 50, "[" * 50, "1" * 500,
    "{}", "[a]", "[]", "{type: {}}",
)  # fmt: skip

Chance = random.Random
Mutation = Callable[[str, Chance], str]


def cut(text: str, chance: Chance) -> str:
    return text[: chance.randrange(len(text))]


def drop_characters(text: str, chance: Chance) -> str:
    start = chance.randrange(len(text))
    return text[:start] + text[start + chance.randint(1, 8) :]


def insert(text: str, chance: Chance) -> str:
    place = chance.randrange(len(text))
    return text[:place] + chance.choice(SNIPPETS) + text[place:]


def replace_token(text: str, chance: Chance) -> str:
    tokens = list(TOKEN.finditer(text))
    old = chance.choice(tokens)
    new = chance.choice([chance.choice(tokens)[0], chance.choice(SNIPPETS)])
    return text[: old.start()] + new + text[old.end() :]


def replace_number(text: str, chance: Chance) -> str:
    numbers = [found for found in TOKEN.finditer(text) if found[0][0].isdigit()]
    if not numbers:
        return text
    old = chance.choice(numbers)
    return text[: old.start()] + chance.choice(NUMBERS) + text[old.end() :]


def change_lines(text: str, chance: Chance) -> str:
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


ANYWHERE: Sequence[Mutation] = (cut, drop_characters, insert, replace_token, change_lines, replace_token, change_lines)
WITHIN: Sequence[Mutation] = (replace_number, replace_number, replace_number, replace_token, insert)


def mutated(text: str, chance: Chance) -> str:
    """One to four damages; half of the texts keep their lines, so that more of them mean something."""
    mutations = chance.choice([ANYWHERE, WITHIN])
    for _ in range(chance.randint(1, 4)):
        if len(TOKEN.findall(text)) > 1:
            text = chance.choice(mutations)(text, chance)
    return text


def mutated_bytes(raw: bytes, chance: Chance) -> bytes:
    """Some bytes changed, mostly at the beginning where the structure is; the end cut off, a stretch doubled."""
    found = bytearray(raw)
    for _ in range(chance.randint(1, 6)):
        where = len(found) if chance.random() < 0.5 else min(len(found), 2000)
        found[chance.randrange(where)] = chance.choice([chance.randrange(256), 0, 1, 127, 128, 255])
    if chance.random() < 0.15:
        return bytes(found[: chance.randrange(len(found))])
    if chance.random() < 0.1:
        start = chance.randrange(len(found))
        found[start:start] = found[start : start + chance.randint(1, 400)]
    return bytes(found)
