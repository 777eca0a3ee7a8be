"""Names for other programs, made of letters, digits and _, each unique."""

from __future__ import annotations

import re
from collections.abc import Container, Iterable
from itertools import chain, count

_UMLAUTS = str.maketrans({"ä": "ae", "ö": "oe", "ü": "ue", "Ä": "Ae", "Ö": "Oe", "Ü": "Ue", "ß": "ss"})


class Names:
    """Generator of names of letters, digits and _, none of them twice and none that is reserved.

    >>> names = Names(reserved=["model"])
    >>> [names.new(wish) for wish in ("Disk 1", "Disk-1", "model", "2nd")]
    ['Disk_1', 'Disk_1_2', 'model_2', 'n2nd']
    """

    def __init__(self, reserved: Iterable[str] = ()) -> None:
        self.taken: set[str] = set(reserved)

    def new(self, wish: str) -> str:
        """Unused name as near to ``wish`` as possible."""
        name = free_name(plain_name(wish), self.taken)
        self.taken.add(name)
        return name


def plain_name(wish: str) -> str:
    """Name of letters, digits and _ as near to ``wish`` as possible.

    >>> plain_name("Zyl. 1"), plain_name("Kühlerlüfter"), plain_name("2nd")
    ('Zyl_1', 'Kuehlerluefter', 'n2nd')
    """
    plain = re.sub(r"[^A-Za-z0-9_]+", "_", wish.translate(_UMLAUTS)).strip("_") or "n"
    return plain if plain[0].isalpha() else f"n{plain}"


def free_name(wish: str, taken: Container[str]) -> str:
    """Name ``wish`` itself, or with the first number from 2 at which it is not taken."""
    numbered = (f"{wish}_{number}" for number in count(2))
    return next(name for name in chain([wish], numbered) if name not in taken)
