"""Options on the toothed wheels of a record, and the rotation of the wheels they name."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import click

from torsionnet.cli.declarations import Arguments, option
from torsionnet.cli.options import EntryOption, EntryType, PairOption
from torsionnet.core.errors import UsageError

if TYPE_CHECKING:
    from torsionnet.response.recording import Recording
    from torsionnet.signals.rotation.wheel_rotation import WheelRotation


class NamedWheel(NamedTuple):
    """Channel with its pulses per turn and those that a gap lacks; no pulses: a signal."""

    name: str
    teeth: int = 0
    missing: int = 0


class TeethOption(EntryType):
    """Type of an option value ``WHEEL=TEETH``, as ``fly=60`` or ``fly=60-2``, read as a channel and its teeth."""

    name = "WHEEL=TEETH"

    def __init__(self, *, bare: bool = False) -> None:
        self.bare = bare
        if bare:
            self.name = "WHEEL=TEETH|CHANNEL"

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        name, equals, text = (part.strip() for part in value.partition("="))
        if self.bare and name and not equals:
            return NamedWheel(name)
        teeth, _, missing = text.partition("-")
        if not (name and teeth.strip().isdigit() and (missing.strip().isdigit() or "-" not in text)):
            self.fail(f'expected {self.name}, as fly=60, or fly=60-2 with a gap of two, got "{value}"', param, ctx)
        return NamedWheel(name, int(teeth), int(missing or 0))


class WheelReading(Arguments):
    """Options on reading the pulses of toothed wheels, such as their pitch patterns and gear ratios."""

    wheels: tuple[NamedWheel, ...] = option(
        "--wheel", type=TeethOption(), help="Another wheel: its vibration is tracked, too. Repeatable."
    )
    patterns: tuple[tuple[str, str], ...] = option(
        "--pattern",
        type=PairOption("WHEEL", "FILE", "fly=flywheel.yaml"),
        help="Pitch pattern of a wheel, as calibrate-wheel writes it; it is removed. Repeatable.",
    )
    ratios: tuple[tuple[str, str], ...] = option(
        "--ratio",
        type=PairOption("WHEEL", "RATIO", "gear=2.5"),
        help="Turns of the reference shaft per turn of a wheel; negative: it turns against it. Repeatable.",
    )
    tick: float | None = option(
        "--tick",
        type=EntryOption("TIME", "signals.orders.tracking_entries:TICK"),
        help="Of one count, where pulses were stamped by a counter: 12.5ns.",
    )

    def record_of(self, path: str, names: list[str]) -> Recording:
        """Recording of the channels of pulses named, without signals; their times in s."""
        from torsionnet.io.recording_files import read_recording
        from torsionnet.signals.rotation.pulse_reading import PulseReading

        wanted = list(dict.fromkeys(names))
        return read_recording(path, names=wanted, pulse_readings=dict.fromkeys(wanted, PulseReading(tick=self.tick)))

    def rotation(self, record: Recording, one: NamedWheel, index: str | None) -> WheelRotation:
        """Rotation of the wheel of a record, in rad of the reference shaft."""
        from torsionnet.io.wheel_pattern_files import read_wheel_pattern
        from torsionnet.signals.rotation.wheel import Wheel
        from torsionnet.signals.rotation.wheel_rotation import wheel_rotation

        ratio = self._ratio(one.name)
        wheel = Wheel(teeth=one.teeth, missing_teeth=one.missing, ratio=abs(ratio), reversed=ratio < 0)
        file = dict(self.patterns).get(one.name)
        pattern = read_wheel_pattern(file) if file else None
        turns = record.pulses_of(index) if index and index != one.name and abs(ratio) == 1 else None
        return wheel_rotation(record.pulses_of(one.name), wheel, pattern, index=None if one.missing else turns)

    def check_wheels(self, known: list[str]) -> None:
        """Refuse a pattern or a ratio of a wheel that no option names."""
        for what, given in (("pattern", self.patterns), ("ratio", self.ratios)):
            for name, _ in given:
                if name not in known:
                    raise UsageError(f"--{what} {name}: there is no wheel of this name; there is {', '.join(known)}")

    def _ratio(self, name: str) -> float:
        text = dict(self.ratios).get(name, "1")
        try:
            ratio = float(text)
        except ValueError:
            ratio = 0.0
        if not 0 < abs(ratio) < float("inf"):
            raise UsageError(f"--ratio {name}: a ratio is a number other than 0, as 2.5, got {text}")
        return ratio
