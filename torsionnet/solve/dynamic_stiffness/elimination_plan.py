"""Steps of an elimination on the graph, as operations on numbered slots without numerical values.

:mod:`torsionnet.solve.dynamic_stiffness.graph_plan` makes them.
Slots hold dynamic stiffnesses of rows kappa, weights of loads w, and motions of rows; each is an array over points.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple


class EliminatedPair(NamedTuple):
    """Pair of rows i < j that adds factor kappa_i kappa_j / S to the stiffness ``target`` in an elimination."""

    i: int
    j: int
    factor: float
    target: int


class PassedLoad(NamedTuple):
    """Load that an eliminated coordinate passes on to another row, w[target] += factor (kappa_i / S) w[slot]."""

    slot: int
    i: int
    factor: float
    target: int


@dataclass(frozen=True)
class MotionStep:
    """Formula for the motion of a row by back-substitution, once later coordinates are known.

    value[slot] = load f_v / S + sum of factor (kappa_i / S) value[source] over ``parts`` (i, factor, source).
    """

    slot: int
    load: float
    parts: tuple[tuple[int, float, int], ...]


@dataclass(frozen=True)
class EliminationStep:
    """Elimination of one coordinate, with the stiffnesses and loads that pass on to its neighbours.

    Attributes
    ----------
    coordinate : int
    handed_on : tuple of (slot, ((slot, weight), ...))
        Before all else: kappa of a row that other rows take over.
    terms : tuple of (slot, a_v^2)
        S = sum of a_v^2 kappa[slot].
    pairs : tuple of EliminatedPair
    loads : tuple of (slot, l_v)
        f_v = sum of l_v w[slot].
    passed : tuple of Passed
    motions : tuple of MotionStep
        Needed on the way back, in reverse order of the steps.
    shared : tuple of int
        Places among the terms of which kappa_i / S is needed.
    """

    coordinate: int
    handed_on: tuple[tuple[int, tuple[tuple[int, float], ...]], ...]
    terms: tuple[tuple[int, float], ...]
    pairs: tuple[EliminatedPair, ...]
    loads: tuple[tuple[int, float], ...]
    passed: tuple[PassedLoad, ...]
    motions: tuple[MotionStep, ...]
    shared: tuple[int, ...]


@dataclass(frozen=True)
class ReactionStep:
    """Formula for the torque that holds an imposed angle or a rigid connection, as sums over stiffnesses and loads.

    The sum is of factor kappa[slot] value[motion] over ``laws``, and of factor w[slot] over ``loads``.
    """

    laws: tuple[tuple[int, float, int], ...]
    loads: tuple[tuple[int, float], ...]


@dataclass(frozen=True)
class EliminationPlan:
    """Order and steps that eliminate all coordinates from the equations of motion, for all frequencies and values.

    Attributes
    ----------
    sources : tuple of ((law, factor), ...)
        kappa[slot] = sum of factor kappa_law, for the first slots.
    n_slots, n_loads, n_motions : int
        Numbers of slots for kappa, for weights of loads and for motions.
    n_excitations : int
    weights : tuple of (slot, excitation, factor)
        Loads to begin with.
    given : tuple of (motion slot, (motion under every excitation, ...))
        Motions that need not be solved for.
    steps : tuple of EliminationStep
    outputs : tuple of (motion slot or -1, factor)
    reactions : tuple of ReactionStep
    subtracts : bool
        Whether rows were split into links and grounds, some of them negative, which costs digits anywhere.
    """

    sources: tuple[tuple[tuple[int, float], ...], ...]
    n_slots: int
    n_loads: int
    n_motions: int
    n_excitations: int
    weights: tuple[tuple[int, int, float], ...]
    given: tuple[tuple[int, tuple[float, ...]], ...]
    steps: tuple[EliminationStep, ...]
    outputs: tuple[tuple[int, float], ...]
    reactions: tuple[ReactionStep, ...]
    subtracts: bool
