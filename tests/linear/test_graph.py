"""The drivetrain as a networkx graph."""

from itertools import pairwise

import pytest
from support.models import EVERY_ELEMENT, geared_line

import torsionnet as tn


def around(element):
    """The element with an inertia on every node, so that it makes a whole drivetrain."""
    nodes = [node for node in dict.fromkeys(element.ports.values()) if node != "ground"]
    return tn.Drivetrain("one", [element, *(tn.Inertia(f"J_{node}", node=node, inertia=1) for node in nodes)])


def test_nodes_in_the_order_of_the_drivetrain():
    rig = geared_line()
    assert tuple(rig.graph().nodes) == rig.nodes


def test_edges_of_a_line():
    graph = geared_line().graph()
    found = {(first, second): data["element"] for first, second, data in graph.edges(data=True)}
    assert found == {("m", "p"): "meter", ("p", "g"): "soft", ("g", "o"): "stage", ("o", "h"): "stiff"}
    assert graph.edges["g", "o", "stage"]["kind"] == "gear"


def test_elements_with_one_port_are_at_their_node():
    graph = geared_line().graph()
    assert graph.nodes["m"]["elements"] == ("motor",)
    assert graph.nodes["h"]["elements"] == ("brake",)
    assert graph.nodes["p"]["elements"] == ()


def test_ground_is_there_only_if_something_is_attached():
    assert "ground" not in geared_line().graph()
    assert "ground" in tn.load("amt_rig").graph()


@pytest.mark.parametrize("kind", ["planetary", "differential", "gear"])
def test_three_ports_are_connected_in_pairs(kind):
    graph = around(EVERY_ELEMENT[kind]).graph()
    edges = {frozenset(ends) for *ends, name in graph.edges(keys=True) if name == "e"}
    assert edges == {frozenset("ab"), frozenset("ac"), frozenset("bc")}


def test_a_shaft_is_a_chain_of_its_segments():
    graph = around(EVERY_ELEMENT["shaft"]).graph()
    edges = {frozenset(ends) for *ends, name in graph.edges(keys=True) if name == "e"}
    assert edges == {frozenset(pair) for pair in pairwise(("a", "e.1", "e.2", "b"))}


def test_parallel_elements_are_edges_of_their_own():
    masses = [tn.Inertia(f"J_{node}", node=node, inertia=1) for node in "ab"]
    both = [tn.Spring(name, nodes=("a", "b"), stiffness=2) for name in ("k_1", "k_2")]
    assert tn.Drivetrain("two", [*masses, *both]).graph().number_of_edges("a", "b") == 2


def test_switched_off_elements_take_no_part():
    rig = tn.load("amt_rig").switched(off=["bearing", "support", "oil"])
    assert "ground" not in rig.graph()
