"""Numbers and names of modes, counted in one way for tables, pictures, files and studies."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence

from torsionnet.core.entries.spec import Schema
from torsionnet.core.errors import UsageError

MODE_NUMBER: Schema = {"type": ["integer", "null"], "description": "null for rigid bodies and real poles"}
"""JSON Schema of the number of a mode, null where the mode does not vibrate."""
RIGID, REAL, OSCILLATORY = "rigid body", "real pole", "oscillatory"
"""Names of the kinds of modes, that of a rigid body, of a real pole and of a vibration."""
MODE_KIND: Schema = {"enum": [RIGID, REAL, OSCILLATORY]}
"""JSON Schema of the kind of a mode, a text: rigid body, real pole or oscillatory."""
COUNTING_NOTE = "mode 1 is the lowest vibration; rigid bodies and real poles have no number"
"""Text of the note below tables of modes on how they are counted."""


def mode_numbers(kinds: Sequence[str]) -> tuple[int | None, ...]:
    """Number of every mode by rising ``|lambda|``, counted from 1 for those that vibrate, None for the others.

    Examples
    --------
    >>> mode_numbers(["rigid body", "real pole", "oscillatory", "oscillatory"])
    (None, None, 1, 2)
    """
    found: list[int | None] = []
    count = 0
    for kind in kinds:
        count += kind == OSCILLATORY
        found.append(count if kind == OSCILLATORY else None)
    return tuple(found)


def mode_names(kinds: Sequence[str]) -> tuple[str, ...]:
    """Name of every mode for headings, its number or its kind, with a letter if several modes are of that kind.

    Examples
    --------
    >>> mode_names(["rigid body", "real pole", "oscillatory", "real pole"])
    ('rigid body', 'real pole a', '1', 'real pole b')
    """
    total, met = Counter(kinds), Counter[str]()
    names = []
    for kind, number in zip(kinds, mode_numbers(kinds), strict=True):
        met[kind] += 1
        names.append(str(number or (kind if total[kind] == 1 else f"{kind} {_letters(met[kind])}")))
    return tuple(names)


def _letters(number: int) -> str:
    """Letters in the name of a mode for a number from 1, a to z, then aa, ab and so on."""
    whole, rest = divmod(number - 1, 26)
    return (_letters(whole) if whole else "") + chr(ord("a") + rest)


def index_of_mode(number: int, kinds: Sequence[str]) -> int:
    """Index of a mode in the sequence of all modes' kinds, from its number, which counts vibrations from 1.

    Raises
    ------
    UsageError
        There is no mode of this number.
    """
    numbers = mode_numbers(kinds)
    if number in numbers:
        return numbers.index(number)
    count = sum(one is not None for one in numbers)
    have = f"there are {count}, counted" if count else "nothing vibrates; modes are counted"
    raise UsageError(f"there is no mode {number}; {have} from 1 without rigid bodies and real poles")
