"""Base class and register of excitations by order, and their torques by order."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar, Self, TypeVar

import numpy as np
from numpy.typing import NDArray

from torsionnet.base.entries.declared import Declared
from torsionnet.base.entries.scalars import Value
from torsionnet.base.entries.spec import Flag, entry
from torsionnet.base.errors import EntryPath, Fault
from torsionnet.model.channels import Input
from torsionnet.model.element_base.element_entries import NodeName
from torsionnet.model.elements import Element

# Rated torque and speed of a machine, as its excitation states them.

MECHANICAL_EFFICIENCIES = (0.75, 1.0)
"""Smallest and largest usual power of engines at the coupling over the indicated power."""


@dataclass(frozen=True)
class Rating:
    """Mean torque of a machine in N m at its rated speed in rad/s, with the entries that state both.

    Attributes
    ----------
    torque : float
        N m, above zero if the machine drives, below zero if it is driven.
    path, speed_path : Path
        Entries of torque and speed below the excitation; the second is empty without a stated speed.
    speed : float, optional
        Speed of its shaft, rad/s.
    power : float, optional
        Power in W, where the entry states a power.
    exponent : float
        Exponent of the torque over speed.
    shares : tuple of float
        Least and largest power at the shaft over the rated power: 1 but for indicated powers.
    """

    torque: float
    path: EntryPath
    speed: float | None = None
    speed_path: EntryPath = ()
    power: float | None = None
    exponent: float = 0.0
    shares: tuple[float, float] = (1.0, 1.0)

    def at(self, speed: float) -> tuple[float, ...]:
        """Power in W as stated, and, with a stated speed, power in W at ``speed`` in rad/s by the torque curve."""
        stated = self.torque * speed if self.power is None else self.power
        if not self.speed:
            return (stated,)
        # P(Omega) = T_rated (Omega/Omega_rated)^exponent Omega.
        return stated, self.torque * (speed / self.speed) ** self.exponent * speed


ORDER = Value("vibrations per revolution", "1", exclusive=True, below=10_000)
FloatArray = NDArray[np.float64]
ComplexArray = NDArray[np.complex128]

_KINDS: dict[str, type[OrderExcitation]] = {}
"""Class of every kind of excitation, by the word in ``type:``, in alphabetical order."""
T = TypeVar("T", bound="type[OrderExcitation]")


@dataclass(frozen=True, eq=False)
class TorqueShares:
    """Torques on one node each in N m, added to the sum of an excitation one at a time or with factors.

    Attributes
    ----------
    labels : tuple of str
        Names of the torques, as "misfire of cylinder 3".
    nodes : tuple of str
        The node of each.
    amplitudes : (n_shares, n_speeds, n_orders) complex array
        N m, peak values.
    parts : tuple of str
        Part of the machine with each torque: a cylinder that misfires does not scatter.
    """

    labels: tuple[str, ...]
    nodes: tuple[str, ...]
    amplitudes: ComplexArray
    parts: tuple[str, ...]


@dataclass(frozen=True, eq=False)
class OrderTorques:
    """Torques on nodes in N m by order, over speed.

    T(t) = Re sum_i T_i exp(j (h_i phi + 2 pi f_i t)), phi the angle of the shaft.

    A positive torque drives its shaft. Excitations that impose a motion give angles of nodes in their sense of
    rotation, or twists: the angle in rad by which the shaft of the excitation, where it enters the element, is ahead
    of the unloaded position.

    Attributes
    ----------
    orders : (n_lines,) array
        Vibrations per revolution of the shaft; 0 where a line does not follow the speed.
    nodes : tuple of str
        Nodes on which the torques act, or elements whose twist is imposed.
    amplitudes : (n_speeds, n_lines, n_nodes) complex array
        N m or rad, peak values.
    fixed : (n_lines,) array, optional
        Frequencies f_i in Hz that go with the orders; without, all lines follow the speed.
    alternatives : TorqueShares, optional
        One of these comes on top, whichever is worst.
    scatter : TorqueShares, optional
        All of these come on top with factors from -1 to 1, in the worst combination.
    """

    orders: FloatArray
    nodes: tuple[str, ...]
    amplitudes: ComplexArray
    fixed: FloatArray | None = None
    alternatives: TorqueShares | None = None
    scatter: TorqueShares | None = None


@dataclass(frozen=True, kw_only=True)
class OrderExcitation(Declared):
    """Base class of excitations; each ``type:`` is a subclass registered by :func:`register_excitation`."""

    article: ClassVar[str] = "an excitation"

    enabled: bool = entry(Flag("whether it acts before a configuration says otherwise"), True)

    common: ClassVar[tuple[str, ...]] = ("enabled",)

    @property
    def shaft(self) -> str:
        """Name of the node of the shaft whose revolutions the orders of the excitation count."""
        raise NotImplementedError

    @property
    def quantity(self) -> str:
        """Name of the quantity that the excitation imposes.

        ``torque`` on nodes, ``angle`` of nodes or ``twist`` of elements.
        """
        return "torque"

    @property
    def node_entries(self) -> tuple[tuple[EntryPath, str], ...]:
        """Path and node of every entry that names a node on which the excitation acts."""
        return ()

    @property
    def element_entry(self) -> tuple[EntryPath, str] | None:
        """Path and name of the element whose twist the excitation imposes, or None."""
        return None

    @property
    def nodes(self) -> tuple[str, ...]:
        """Names of the nodes on which the excitation acts, without duplicates."""
        return tuple(dict.fromkeys(node for _, node in self.node_entries))

    @property
    def reaction_entry(self) -> tuple[EntryPath, str] | None:
        """Path and node of the entry for the node that takes reactions, or to which motions are relative, or None."""
        return None

    @property
    def reaction_node(self) -> str | None:
        """Name of the node that takes the reaction torques of the excitation; None for the ground."""
        return None if self.reaction_entry is None else self.reaction_entry[1]

    @property
    def crankshaft(self) -> frozenset[str]:
        """Names of the crankshaft's nodes, from which firing angles count; empty for machines without pistons."""
        return frozenset()

    @property
    def is_phased(self) -> bool:
        """Whether the excitation gives its crank angle against the first engine of the model."""
        return False

    @property
    def absorbs(self) -> bool:
        """Whether the machine of the excitation takes work, as a compressor does."""
        return False

    @property
    def numbers(self) -> Mapping[int, str]:
        """Node of each cylinder, by cylinder number; empty for machines without pistons."""
        return {}

    @property
    def has_lost_cylinder(self) -> bool:
        """Whether a cylinder works without injection or without gas torque."""
        return False

    @property
    def has_lost_torque(self) -> bool:
        """Whether a cylinder gives less torque than the others, or none."""
        return False

    def mean_torque_shares(self, speeds: FloatArray) -> dict[int, FloatArray]:
        """Mean torque of each cylinder over that of the same cylinder working, (n_speeds,), by cylinder number."""
        return {number: np.ones(len(speeds)) for number in self.numbers}

    def all_working(self) -> Self:
        """Copy of the excitation in which no cylinder is lost; without pistons it is as it is."""
        return self

    def at_load(self, share: float) -> Self:
        """Copy of the excitation at a share of the rated load of the engine; without pistons it is as it is."""
        del share
        return self

    def channel(self, place: str) -> Input:
        """Input channel of the excitation at one of its nodes or elements."""
        return Input(self.quantity, place, self.reaction_node)

    def with_element_data(self, elements: Mapping[str, Element]) -> Self:
        """Copy of the excitation with data of the elements that it names: a shaft, a number of teeth."""
        del elements
        return self

    def element_faults(self, elements: Mapping[str, Element]) -> list[Fault]:
        """Faults of entries that do not fit the element named by the excitation."""
        del elements
        return []

    def torques(self, speeds: FloatArray) -> OrderTorques:
        """Torques in N m, or angles or twists in rad, by order at speeds of the shaft in rad/s."""
        raise NotImplementedError

    def phase_vectors(self, order: float) -> dict[str, tuple[str, complex]]:
        """Node and phase vector ``exp(-j order alpha)`` of each acting part of the machine, by name.

        0 for a part out of action.
        """
        del order
        return {node: (node, 1.0 + 0j) for node in self.nodes}

    @property
    def rating(self) -> Rating | None:
        """Rated mean torque (N m) and speed (rad/s) as the excitation states them, or None."""
        return None

    def remarks(self, speeds: FloatArray | None) -> list[Fault]:
        """Faults, warnings and notes on the excitation at speeds of its shaft in rad/s.

        None where these are not known.
        """
        del speeds
        return []


@dataclass(frozen=True, kw_only=True)
class ReactingExcitation(OrderExcitation):
    """Base class of excitations between two nodes, as a crankshaft and the block, or a pump and its housing."""

    reaction: str | None = entry(
        NodeName(
            "the node that takes the opposite torques, or that an imposed motion is relative to; default: the ground",
            allow_ground=False,
        ),
        None,
    )

    @property
    def reaction_entry(self) -> tuple[EntryPath, str] | None:
        return (("reaction",), self.reaction) if self.reaction else None

    def contradictions(self) -> list[Fault]:
        if self.reaction not in self.nodes:
            return []
        text = f'"{self.reaction}" takes the opposite of a torque on itself; name the node of the housing or block'
        return [Fault(text, ("reaction",), kind="same-node")]


def register_excitation(cls: T) -> T:
    """Class decorator that registers an excitation type under its ``kind``."""
    known: dict[str, type[OrderExcitation]] = {**_KINDS, cls.kind: cls}
    _KINDS.clear()
    _KINDS.update(sorted(known.items()))
    return cls


def excitation_kinds() -> Mapping[str, type[OrderExcitation]]:
    """Class of every registered kind of excitation, by the word in ``type:``."""
    return _KINDS
