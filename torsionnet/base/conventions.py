"""Conventions for showing results, units of angle and frequency, kind of amplitude, dB reference.

Results are kept in SI with frequencies in Hz, for motion ~ exp(+j omega t), so that a lag is a negative phase.

Here as well: numbers and names of modes, counted in one way for tables, pictures, files and studies.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass

from torsionnet.base.entries.spec import Schema
from torsionnet.base.errors import UsageError, did_you_mean

ANGLES = {"rad": 1.0, "deg": 180 / math.pi}
"""Factor from rad to each unit in which angles are shown, by name of the unit."""
FREQUENCIES = {"Hz": 1.0, "cpm": 60.0, "rpm": 60.0, "rad/s": 2 * math.pi}
"""Factor from Hz to each unit in which frequencies are shown, by name of the unit."""
AMPLITUDES = {"peak": 1.0, "RMS": 1 / math.sqrt(2), "peak-to-peak": 2.0}
"""Factor from the peak value of a vibration to each kind of amplitude, by name of the kind."""


@dataclass(frozen=True)
class Conventions:
    """Units of angle and frequency, kind of amplitude and dB reference of tables, files and plots.

    Attributes
    ----------
    angle : {"rad", "deg"}
    frequency : {"Hz", "cpm", "rpm", "rad/s"}
    amplitude : {"peak", "RMS", "peak-to-peak"}
        Kind of amplitude of vibrations; transfer functions do not depend on it.
    db_reference : float
        Value shown as 0 dB, in the unit shown.

    Examples
    --------
    >>> Conventions(angle="deg").scale("rad")
    57.29577951308232
    """

    angle: str = "rad"
    frequency: str = "Hz"
    amplitude: str = "peak"
    db_reference: float = 1.0

    def __post_init__(self) -> None:
        for name, known in (("angle", ANGLES), ("frequency", FREQUENCIES), ("amplitude", AMPLITUDES)):
            chosen = getattr(self, name)
            if chosen not in known:
                raise UsageError(
                    f'{name} "{chosen}" is not known{did_you_mean(str(chosen), known)}; choose {", ".join(known)}',
                    kind="unknown-word",
                )
        if not (math.isfinite(self.db_reference) and self.db_reference > 0):
            raise UsageError(
                f"the dB reference must be a positive number, got {self.db_reference}", kind="out-of-range"
            )

    def scale(self, unit: str) -> float:
        """Factor from an SI unit to the unit in which its values are shown; not 1 for angles and stresses."""
        return ANGLES[self.angle] if "rad" in unit else 1e-6 if unit == "Pa" else 1.0

    def unit(self, unit: str) -> str:
        """Name of the unit in which values of an SI unit are shown, such as deg for rad."""
        return "N/mm^2" if unit == "Pa" else unit.replace("rad", self.angle)

    def unit_of_column(self, unit: str) -> str:
        """Name of the unit in which a table's column of an SI unit, or of Hz, is shown."""
        return self.frequency if unit == "Hz" else self.unit(unit)

    def scale_of_column(self, unit: str) -> float:
        """Factor from the SI unit, or Hz, of a table's column to the unit in which it is shown."""
        return self.frequency_scale if unit == "Hz" else self.scale(unit)

    @property
    def frequency_scale(self) -> float:
        """Factor from Hz to the unit in which frequencies are shown."""
        return FREQUENCIES[self.frequency]

    @property
    def amplitude_scale(self) -> float:
        """Factor from the peak value of a vibration to the kind of amplitude shown."""
        return AMPLITUDES[self.amplitude]


SI = Conventions()
"""Conventions with SI units, Hz and peak amplitudes."""


MODE_NUMBER: Schema = {"type": ["integer", "null"], "description": "null for rigid bodies and real poles"}
"""JSON Schema of the number of a mode, null where the mode does not vibrate."""
RIGID, REAL, OSCILLATORY = "rigid body", "real pole", "oscillatory"
"""Names of the kinds of modes, that of a rigid body, of a real pole and of a vibration."""
MODE_KIND: Schema = {"enum": [RIGID, REAL, OSCILLATORY]}
"""JSON Schema of the kind of a mode, a text: rigid body, real pole or oscillatory."""
COUNTING_NOTE = "mode 1 is the lowest vibration; rigid bodies and real poles have no number"
NO_VIBRATION = "none of these is a vibration; rigid bodies and real poles have no number"
"""Text of the note below tables of modes on how they are counted."""


def counting_notes(numbers: Sequence[int | None]) -> tuple[str, ...]:
    """Note on how modes with these numbers are counted, nothing where all have one.

    Examples
    --------
    >>> counting_notes([None, None])
    ('none of these is a vibration; rigid bodies and real poles have no number',)
    """
    if None not in numbers:
        return ()
    return (NO_VIBRATION if set(numbers) == {None} else COUNTING_NOTE,)


def mode_numbers(kinds: Sequence[str]) -> tuple[int | None, ...]:
    """Number of every mode by rising ``|lambda|``, counted from 1 for those that vibrate, None for the others.

    Examples
    --------
    >>> mode_numbers(["rigid body", "real pole", "oscillatory", "oscillatory"])
    (None, None, 1, 2)
    """
    numbers: list[int | None] = []
    count = 0
    for kind in kinds:
        count += kind == OSCILLATORY
        numbers.append(count if kind == OSCILLATORY else None)
    return tuple(numbers)


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
    count = sum(number is not None for number in numbers)
    have = f"there are {count}, counted" if count else "nothing vibrates; modes are counted"
    raise UsageError(
        f"there is no mode {number}; {have} from 1 without rigid bodies and real poles", kind="unknown-mode"
    )
