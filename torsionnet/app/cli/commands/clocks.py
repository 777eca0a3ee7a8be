"""Command ``torsionnet clocks``, which brings the record of a second system to the clock of the first."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from torsionnet.app.cli.command import TABLE, Answer, Command
from torsionnet.app.cli.options import WrongUsage, argument, file_option, option
from torsionnet.app.cli.pulse_options import PulseOptions

if TYPE_CHECKING:
    from torsionnet.signals.recording import Recording
    from torsionnet.signals.rotation.clock_drift import ClockDrift


class ClocksCommand(Command):
    """Drift and offset between the clocks of two systems, from a signal or a rotation that both recorded.

    A time t of RECORD is offset + (1 + drift) t of OTHER. With -o OTHER is written on the clock of RECORD.

    \b
    torsionnet clocks rig.npz telemetry.npz --channel T -o together.npz
    torsionnet clocks rig.npz telemetry.npz --pulses crank=60 --same-start -o together.npz
    """

    forms = TABLE

    record: str = argument("RECORD")
    other: str = argument("OTHER")
    reading: PulseOptions
    channel: str | None = option("--channel", metavar="CHANNEL", help="Signal that both recorded, as a torque.")
    same_start: bool = option("--same-start", help="Time 0 is the same on both clocks, as by a common trigger.")
    output_file: str | None = file_option("OTHER on the clock of RECORD; the ending tells the format.")

    def answer(self) -> Answer:
        from torsionnet.base.table import result_table
        from torsionnet.signals.records.recording_files import write_recording
        from torsionnet.signals.rotation.clock_drift import ClockDrift, on_first_clock

        found, theirs = self._found()
        table = result_table(f"clock of {self.other} against {self.record}", [found], ClockDrift, notes=found.remarks)
        moved = on_first_clock(theirs, found)
        return Answer(
            screen=lambda: [table],
            csv=lambda: [("", table)],
            data=lambda: found,
            files=[(self.output_file, lambda file: write_recording(moved, file))],
        )

    def _found(self) -> tuple[ClockDrift, Recording]:
        """Clocks of both systems from what both recorded, and the whole record of the second system."""
        from torsionnet.io.turning_records import read_turning_record
        from torsionnet.io.wheel_files import channels_of, patterns_of
        from torsionnet.signals.records.recording_files import channel_names, read_recording
        from torsionnet.signals.rotation.clock_drift import rotation_clocks, signal_clocks
        from torsionnet.signals.rotation.rotations_of_wheels import rotations_of_wheels

        wheels = self.reading.wheels()
        if (self.channel is None) == (len(wheels) != 1):
            raise WrongUsage(
                "name what both recorded: --channel of a signal, or --pulses of one wheel", kind="missing-entry"
            )
        if self.channel is not None:
            if self.same_start:
                raise WrongUsage(
                    "--same-start belongs to --pulses: a signal tells the offset by itself", kind="needless-entry"
                )
            first, second = (self._signal(path, self.channel) for path in (self.record, self.other))
            theirs = read_recording(self.other, **self.reading.arguments)
            return replace(signal_clocks(first, second, self.channel), found_from=self.channel), theirs

        channels = channels_of(wheels)
        ((name, _),) = channels.items()
        marks = self.reading.marks({one.index for one in channels.values()}, wheels)
        kept = [one for one in channel_names(self.other) if one not in {name, *marks}]
        records = [
            read_turning_record(path, channels, marks, own, **self.reading.arguments)
            for path, own in ((self.record, ()), (self.other, kept))
        ]
        turned = [rotations_of_wheels(one, channels, patterns_of(wheels), marks=marks)[name] for one in records]
        return replace(rotation_clocks(*turned, same_start=self.same_start), found_from=name), records[1]

    def _signal(self, path: str, name: str) -> Recording:
        from torsionnet.app.cli.record_options import checked_record
        from torsionnet.signals.records.recording_files import read_recording

        record = read_recording(path, names=[name], **self.reading.arguments)
        return checked_record(record, self.reading, path)
