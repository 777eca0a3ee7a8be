"""Titles of configurations in documents, from the titles of their alternatives or from words made of their names."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass

from torsionnet.base.phrases import joined, phrase
from torsionnet.model.configurations import DEFAULT_AXIS, Axes, parse_choice

NEED_A_NOUN = (
    "closed", "constant", "double", "free", "full", "half", "high", "locked", "low", "maximum", "minimum", "no",
    "nominal", "none", "normal", "open", "part", "partial", "quarter", "rated", "reduced", "single", "zero",
)  # fmt: skip
"""Names of alternatives that say little without their axis behind them, as in "full load"."""
STATES = (
    "connected", "disconnected", "disengaged", "engaged", "in", "off", "on", "out", "running", "stopped", "yes",
)  # fmt: skip
"""Names of alternatives that say little without their axis before them, as in "pump off"."""
NORMAL = "normal"
"""Name of an alternative that says enough where there is one axis."""
NUMBER = re.compile(r"\d+|[IVX]+|[A-Z]")
"""Regular expression of names of alternatives that stand behind the name of their axis, as in "gear V"."""
MOST_TITLES = 6
"""Largest number of configurations that a text names one by one."""


@dataclass(frozen=True)
class ConditionTitles:
    """Titles of the configurations that alternatives on the axes of a model make.

    Examples
    --------
    >>> from torsionnet.model.configurations import Overlay
    >>> axes = {"firing": {"normal": Overlay(), "misfire": Overlay()}, "load": {"full": Overlay(), "idle": Overlay()}}
    >>> titles = ConditionTitles(axes)
    >>> print(titles.of("firing=misfire,load=full"), titles.of("firing=normal,load=idle"), sep="; ")
    misfire, full load; normal firing, idle
    """

    axes: Axes

    def of(self, configuration: str) -> str:
        """Title of a configuration by its name, as ``firing=misfire,load=full``; empty for the model as written."""
        return ", ".join(self.alternative(axis, name) for axis, name in self._choice(configuration).items())

    def alternative(self, axis: str, name: str) -> str:
        """Title of an alternative: the one that the model gives, else words made of its name and that of its axis."""
        given = self.axes[axis][name].title
        if given or re.match(r"[A-Za-z]_", name):  # a symbol with an index stays as it is
            return given or name
        words, noun = name.replace("_", " "), axis.replace("_", " ")
        if axis == DEFAULT_AXIS or (len(self.axes) == 1 and (name == NORMAL or NUMBER.fullmatch(name))):
            return words
        if NUMBER.fullmatch(name) or words.lower() in STATES:
            return f"{noun} {words}"
        return f"{words} {noun}" if words.lower() in NEED_A_NOUN else words

    def several(self, configurations: Sequence[str], known: Sequence[str]) -> str:
        """Text that names some of the known configurations: by the alternatives that only they have, else one by one.

        Empty where they are all.

        Examples
        --------
        >>> from torsionnet.model.configurations import Overlay
        >>> of_firing, of_load = ("normal", "misfire"), ("full", "idle")
        >>> axes = {"firing": dict.fromkeys(of_firing, Overlay()), "load": dict.fromkeys(of_load, Overlay())}
        >>> every = [f"firing={firing},load={load}" for firing in of_firing for load in of_load]
        >>> titles = ConditionTitles(axes)
        >>> print(titles.several(every[:2], every), titles.several(every[1:3], every), sep=" | ")
        normal firing | normal firing, idle; misfire, full load
        >>> print(titles.several(every[:3], every))
        normal firing, full load; normal firing, idle; misfire, full load
        """
        chosen, every = self._chosen(configurations), self._chosen(known)
        narrow = {axis: names for axis, names in chosen.items() if names != every[axis]}
        held = [name for name in known if all(self._choice(name).get(axis) in narrow[axis] for axis in narrow)]
        if sorted(held) == sorted(configurations):
            texts = (_either([self.alternative(axis, name) for name in names]) for axis, names in narrow.items())
            return joined(", ", texts)
        rest = [name for name in known if name not in configurations]
        if len(configurations) > MOST_TITLES and 0 < len(rest) < len(configurations):
            return phrase("all but {conditions}", conditions=self.several(rest, known))
        return self.listed(configurations)

    def listed(self, configurations: Sequence[str]) -> str:
        """Text with the titles of configurations one by one, of many the first ones and how many more there are."""
        named = [self.of(name) for name in configurations[:MOST_TITLES]]
        text = joined("; " if len(self.axes) > 1 else ", ", named)
        rest = len(configurations) - len(named)
        return phrase("{conditions} and {count} more", conditions=text, count=rest) if rest else text

    def shared(self, configurations: Sequence[str]) -> str:
        """Title of what configurations have in common; where that is nothing, the titles of all of them."""
        first, *others = map(self._choice, configurations)
        common = {axis: name for axis, name in first.items() if all(choice.get(axis) == name for choice in others)}
        named = [self.alternative(axis, name) for axis, name in common.items()]
        return ", ".join(named) or self.listed(configurations)

    def _choice(self, configuration: str) -> dict[str, str]:
        return parse_choice(configuration, self.axes) if configuration else {}

    def _chosen(self, configurations: Sequence[str]) -> dict[str, dict[str, None]]:
        """Alternatives that configurations have on each axis, each once."""
        chosen: dict[str, dict[str, None]] = {}
        for axis, name in (pair for configuration in configurations for pair in self._choice(configuration).items()):
            chosen.setdefault(axis, {})[name] = None
        return chosen


def _either(titles: Sequence[str]) -> str:
    """Text such as "misfire or gas off"."""
    if len(titles) == 1:
        return titles[0]
    return phrase("{first} or {last}", first=joined(", ", titles[:-1]), last=titles[-1])
