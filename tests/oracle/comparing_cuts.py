"""Poles of transfer functions against measured inputs: the rates at which these can stay zero.

The readings Y of all measured inputs under all excitations vanish together where det D(s) det Y(s) = 0, a polynomial. If
a measured torque parts the drivetrain and everything that drives it is on one side, only the other side counts, as a
drivetrain of its own.
"""

from __future__ import annotations

from functools import cached_property

import networkx as nx
from flint import acb, acb_mat, arb

from oracle.answers import Answer, SingularInputError
from oracle.calls import Context, called, failed
from oracle.comparing_poles import compare_modes
from oracle.description import GROUND, Model, Reading
from oracle.exact import precision
from oracle.poles import Count, Poles, coefficients, precise
from oracle.questions import Asked
from oracle.solution import Mechanics

MOST_FREEDOM = 10


def compare_measured_poles(context: Context, asked: Asked) -> None:
    """All poles, where no law depends on frequency; a torque handed over to ground has nothing behind it."""
    mechanics, measured = context.mechanics, asked.question.measured
    to_ground = any(r.quantity == "torque" and mechanics.parts[r.of].ports[r.port] == GROUND for r in measured)
    if mechanics.is_frequency_dependent or mechanics.freedom > MOST_FREEDOM or to_ground or vanishes(mechanics, asked):
        return
    driven = {"measured_input": list(asked.inputs), "driven_by": list(asked.excitations)}
    outcome = called(lambda: context.drivetrain.modes(**driven))
    rest = cut_off(mechanics.model, measured[0], asked.question.excitations) if len(measured) == 1 else None
    name = "poles of measured inputs" if rest is None else "poles behind a cut"
    if outcome.is_refused and "poles are calculated only" in str(outcome.error) and mechanics.model.imposed:
        context.refused(name)
    elif not failed(context, name, outcome, f"for {asked.inputs}, excitation {asked.excitations}"):
        poles = MeasuredPoles(mechanics, asked) if rest is None else Poles(Mechanics(rest))
        compare_modes(context, name, poles, outcome)


class MeasuredPoles(Poles):
    """Roots of det D det Y."""

    def __init__(self, mechanics: Mechanics, asked: Asked) -> None:
        super().__init__(mechanics)
        self.asked = asked

    def value(self, s: acb, omega: arb | None) -> acb:
        question = self.asked.question
        readings = self.mechanics.at(s, question.excitations, question.measured)
        return super().value(s, omega) * acb_mat(readings).det()

    @cached_property
    def count(self) -> Count:
        """From the coefficients that are not zero."""
        most = 2 * self.mechanics.freedom + 2 * len(self.asked.inputs)
        with precision(precise(most)):
            known = [i for i, x in enumerate(coefficients(lambda s: self.value(s, None), most)) if not x.contains(0)]
        return Count(None, known[0], known[-1] - known[0])


def vanishes(mechanics: Mechanics, asked: Asked) -> bool:
    """Whether the measured inputs are dependent at every s."""
    try:
        return not Answer(mechanics, asked.question).zeros
    except SingularInputError:
        return True


def cut_off(model: Model, measured: Reading, excitations: tuple[tuple[str, str], ...]) -> Model | None:
    """What is behind a measured torque, seen from all that drives; None where it does not part the drivetrain."""
    if measured.quantity != "torque":
        return None
    graph = nx.Graph()
    parts = {part.name: part for part in model.parts}
    for part in model.parts:
        graph.add_node((part.name,))
        graph.add_edges_from(((part.name,), node) for node in (*part.ports.values(), *part.internal) if node != GROUND)
    node = parts[measured.of].ports[measured.port]
    graph.remove_edge((measured.of,), node)
    driven = set().union(*(nx.node_connected_component(graph, at) for _, at in excitations))
    behind = [end for end in ((measured.of,), node) if end not in driven]
    if len(behind) != 1:
        return None
    kept = nx.node_connected_component(graph, behind[0])
    left = tuple(part for part in model.parts if (part.name,) in kept)
    nodes = {end for part in left for end in part.ports.values()}
    inputs = {name: channel for name, channel in model.inputs.items() if channel[0] == "angle" and channel[1] in nodes}
    return Model(left, inputs)
