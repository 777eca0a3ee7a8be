"""Names that another program takes: each plain, each once."""

from __future__ import annotations

import re
from collections.abc import Iterable


class Names:
    """Hands out names of letters, digits and _, none of them twice and none that is reserved.

    >>> names = Names(reserved=["model"])
    >>> [names.new(wish) for wish in ("Disk 1", "Disk-1", "model", "2nd")]
    ['Disk_1', 'Disk_1_2', 'model_2', 'n2nd']
    """

    def __init__(self, reserved: Iterable[str] = ()) -> None:
        self.taken = set(reserved)

    def new(self, wish: str) -> str:
        """A free name as near to ``wish`` as can be."""
        plain = re.sub(r"[^A-Za-z0-9_]+", "_", wish).strip("_") or "n"
        plain = plain if plain[0].isalpha() else f"n{plain}"
        number, name = 1, plain
        while name in self.taken:
            number += 1
            name = f"{plain}_{number}"
        self.taken.add(name)
        return name
