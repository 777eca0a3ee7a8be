"""Separation margins of natural frequencies from shaft speeds, electrical lines and all orders of excitations."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from fractions import Fraction

import numpy as np

from torsionnet.base.errors import UsageError
from torsionnet.linear.assembly.assembled import AssembledModel
from torsionnet.machinery.criticals.critical_speed_search import CrossingSearch, excited_lines
from torsionnet.machinery.criticals.critical_speeds import CriticalSpeed, CriticalSpeeds
from torsionnet.machinery.excitations.electric_machine import ElectricMachine
from torsionnet.machinery.orders.order_line import OrderLine, near_fraction
from torsionnet.machinery.verdicts.margin_rules import MarginRule, margin_rule
from torsionnet.model.speeds import speeds_by_reference

MULTIPLES = (1, 2)
"""Multiples of line frequencies, and of shaft speeds unless a rule names more, that standards compare with modes."""
ELECTRICAL = ", electrical"
"""End of the name of the lines of a machine on an inverter, which are no orders of its shaft."""
FREQUENCY_REACH = 2.0
"""Multiple of the highest compared frequency up to which modes are listed; a mode above it is twice as high as
anything it is compared with."""


def shaft_margins(
    drivetrain: AssembledModel, margin: str | float | MarginRule, *, lowest: int | None = None
) -> CriticalSpeeds:
    """Separation margins of every mode from multiples of shaft speeds and electrical frequencies, and from all orders.

    Multiples are 1 and 2, of shafts up to the tenth where the rule names these (API 618); orders and fixed frequencies
    are those of all excitations that act, unless they are among the multiples. Shafts are those whose mean speeds
    differ, named by their first node; an electric machine counts with its line frequency, or with that of its inverter,
    pole pairs times the speed (slip neglected).

    Parameters
    ----------
    margin : str, float or MarginRule
        As for :meth:`critical_speeds`.
    lowest : int, optional
        Only the lowest so many modes.

    Returns
    -------
    CriticalSpeeds
        Margins as shares of the excitation frequency, with what the rule requires; without torques.

    Raises
    ------
    UsageError
        The model has no range of speeds.

    Examples
    --------
    >>> import torsionnet as tn
    >>> margins = tn.load("reciprocating_compressor_train").shaft_margins("api684", lowest=1)
    >>> sorted({critical.mode.number for critical in margins.crossings})
    [1]
    """
    given = drivetrain.definition.speeds
    if given is None:
        raise UsageError(
            "separation margins need the speeds of the train: speeds: {of: motor, range: 600..1500 rpm}",
            kind="missing-entry",
        )
    speed_range = min(given.values), max(given.values)
    rule = margin_rule(margin)
    lines = [*_shaft_lines(drivetrain, given.of, rule), *_electrical_lines(drivetrain, given.of)]
    # An order of an excitation that is a multiple of a shaft's speed or of a line frequency is that line already.
    known = {(line.relative, line.fixed) for line in lines}
    lines += [line for line in _excitation_lines(drivetrain) if (line.relative, line.fixed) not in known]
    search = CrossingSearch(drivetrain, drivetrain.title, given.of, speed_range, lines, rule, 0.0, lowest)
    # Modes far above all lines keep any margin; the first one is always shown.
    highest = max(np.abs(line.frequency(np.array(speed_range))).max() for line in lines)
    modes = tuple(
        mode for mode in search.modes if not mode.undamped_frequency > FREQUENCY_REACH * highest or mode.number == 1
    )
    return CriticalSpeeds(
        reference=given.of,
        speed_range=speed_range,
        modes=modes,
        crossings=tuple(_required(search.nearest(mode, line), rule) for mode in modes for line in lines),
        lines=tuple(lines),
        nodes=drivetrain.assembly.nodes,
        rule=search.rule,
        title=drivetrain.title,
        condition=drivetrain.configuration,
        notes=tuple(search.notes()),
    )


def _ratios(drivetrain: AssembledModel, reference: str) -> dict[str, Fraction]:
    """Speed of every turning node over that of the reference node, without sign."""
    speeds = speeds_by_reference(drivetrain.definition, drivetrain.exact_values, reference)
    return {node: near_fraction(abs(speed / speeds[reference])) for node, speed in speeds.items() if speed}


def _excitation_lines(drivetrain: AssembledModel) -> Iterator[OrderLine]:
    """Order lines of all excitations that act, over the range of speeds."""
    if any(excitation.enabled for excitation in drivetrain.definition.excitations.values()):
        for group in excited_lines(drivetrain, None, None, None)[0].values():
            yield from group


def _shaft_lines(drivetrain: AssembledModel, reference: str, rule: MarginRule | None) -> Iterator[OrderLine]:
    """Order lines at multiples of the speed of each shaft, the reference shaft first."""
    named_by_rule = [clause.highest for clause in rule.clauses if clause.whole] if rule else []
    multiples = range(1, int(max(named_by_rule, default=MULTIPLES[-1])) + 1)
    ratios = _ratios(drivetrain, reference)
    named: dict[Fraction, str] = {}
    for node in (reference, *ratios):
        if node in ratios:
            # Shafts of one speed have the same lines: the first node of each speed names them.
            named.setdefault(ratios[node], node)
    for ratio, node in named.items():
        yield from (OrderLine(node, float(times), ratio) for times in multiples)


def _required(critical: CriticalSpeed, rule: MarginRule | None) -> CriticalSpeed:
    """Margin of an inverter's frequency as that of the line frequency, which no clause on orders of a shaft covers."""
    return replace(critical, required=rule.fixed) if rule and critical.excitation.endswith(ELECTRICAL) else critical


def _electrical_lines(drivetrain: AssembledModel, reference: str) -> Iterator[OrderLine]:
    """Lines at 1 and 2 times the electrical frequency of each electric machine."""
    ratios = _ratios(drivetrain, reference)
    for name, machine in drivetrain.definition.excitations.items():
        if not isinstance(machine, ElectricMachine):
            continue
        lines = (machine.line, machine.slip, machine.short_circuit)
        # A machine on the mains has a fixed frequency; one on an inverter follows the speed with p n, the slip left
        # out.
        fixed = next((line.frequency for line in lines if line is not None), None)
        if fixed is not None:
            yield from (OrderLine(name, 0.0, Fraction(1), times * fixed) for times in MULTIPLES)
        elif machine.pole_pairs and machine.node in ratios:
            ratio = ratios[machine.node] * machine.pole_pairs
            yield from (OrderLine(f"{name}{ELECTRICAL}", float(times), ratio) for times in MULTIPLES)
