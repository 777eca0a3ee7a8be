"""Command ``torsionnet loops``, which reads stages, friction, free play and loss from loops of torque over twist."""

from __future__ import annotations

from copy import copy
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import click

from torsionnet.app.cli.command import TABLE, Answer
from torsionnet.app.cli.options import ANGLE, EntryOption, OutputFile, file_option, option
from torsionnet.app.cli.record_options import RecordCommand, RecordSpan

if TYPE_CHECKING:
    from torsionnet.signals.torque_loops.loop_result import TorqueLoops

ENDINGS = (".yaml", ".yml")
_ENTRIES = "signals.torque_loops.corrections"


class LoopsCommand(RecordCommand):
    """Stages, friction, free play, stiffness and loss from loops of torque over twist of a component bench.

    The twist is a channel, or two angles, --twist of the driving and --twist of the driven side. Cycles are cut at its
    reversals; the first of those that repeat is left out, and 95 % intervals are those over the others. The loss factor
    eta_s belongs to the secant stiffness k_s, eta_1 to the first harmonic k' + j k''.

    \b
    torsionnet loops bench.csv --torque T --twist gamma --plot loops.png --write-model flywheel.yaml
    torsionnet loops bench.csv --torque T --twist phi_1 --twist phi_2 --delay T=1.2ms --inertia 0.045kg*m^2
    """

    forms = TABLE
    picture = "the loops with their branches and stages"

    torque: str = option("--torque", metavar="CHANNEL", required=True, help="Channel of the torque.")
    twist: tuple[str, ...] = option(
        "--twist", metavar="CHANNEL", required=True, help="Channel of the twist; or twice, driving and driven angle."
    )
    speed_channel: str | None = option("--speed-channel", metavar="CHANNEL", help="Its mean is the speed of a loop.")
    span: RecordSpan
    inertia: float | None = option(
        "--inertia",
        type=EntryOption("INERTIA", f"{_ENTRIES}:INERTIA"),
        help="Moves between torque meter and component; its torque is taken out where the twist is a sine.",
    )
    drift: bool = option("--drift", help="Take the drift of the torque from cycle to cycle out of each cycle.")
    encoder_step: float | None = option(
        "--encoder-step",
        type=EntryOption("ANGLE", f"{_ENTRIES}:STEP"),
        help="Step of the twist, a part of the intervals.  [default: that which the record shows]",
    )
    angle: str = ANGLE
    output_file: str | None = file_option("Write the result, for report --loops; ends in .json.", (".json",))
    model_file: str | None = option(
        "--write-model", type=OutputFile(ENDINGS), help="Write the component as a model file, with intervals."
    )

    def answer(self) -> Answer:
        from torsionnet.app.cli.terminal import print_warnings
        from torsionnet.base.conventions import Conventions
        from torsionnet.io.loop_element import write_loop_element

        loops, shown = self.loops(), Conventions(angle=self.angle)
        print_warnings(loops.notes)
        return Answer(
            screen=lambda: [loops.table(shown)],
            data=lambda: loops,
            csv=lambda: [("", loops.table(shown))],
            files=[
                (self.output_file, loops.to_json),
                (self.model_file, lambda file: write_loop_element(loops, file)),
            ],
            figures=lambda _: [("", loops.figure(conventions=shown))],
        )

    def loops(self) -> TorqueLoops:
        """Loops of the record, without the delays given."""
        from torsionnet.app.cli.record_options import load_record
        from torsionnet.app.cli.terminal import progress
        from torsionnet.signals.recording import Recording
        from torsionnet.signals.torque_loops.loops import loops

        if len(self.twist) > 2:
            raise click.UsageError("a twist is one channel, or two angles: give --twist once or twice")
        self.span.check(self.record)
        # The lateness of the torque is for the loops to take out, and to know of.
        span, late = copy(self.span), dict(self.span.delays).get(self.torque, 0.0)
        span.delays = tuple(one for one in span.delays if one[0] != self.torque)
        names = [self.torque, *self.twist, *([self.speed_channel] if self.speed_channel else [])]
        with progress("loops", None) as advance:
            record = load_record(self.record, self.reading, names, 0.0, advance, span)
            if not isinstance(record, Recording):
                raise click.UsageError("a record of loops is read as a whole: cut it by --start and --stop")
            result = loops(
                record,
                self.torque,
                self.twist[0] if len(self.twist) == 1 else (self.twist[0], self.twist[1]),
                speed_channel=self.speed_channel,
                delay=late,
                inertia=self.inertia or 0.0,
                drift=self.drift,
                encoder_step=self.encoder_step,
            )
        return replace(result, title=Path(self.record).name)
