"""What every excitation by order has: the shaft it runs with, and what it does by order of that shaft."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import Field, dataclass
from typing import Any, ClassVar, Self, TypeVar

import numpy as np
from numpy.typing import NDArray

from torsionnet.core.entries.declared import Declared
from torsionnet.core.entries.scalars import Value
from torsionnet.core.entries.spec import entry
from torsionnet.core.entries.words import Flag
from torsionnet.core.errors import Fault, Path
from torsionnet.model.channels import Input
from torsionnet.model.element_base.nodes import NodeName
from torsionnet.model.elements import Element
from torsionnet.model.excitations.rating import Rating

ORDER = Value("vibrations per revolution", "1", exclusive=True, below=10_000)
FloatArray = NDArray[np.float64]
ComplexArray = NDArray[np.complex128]

_KINDS: dict[str, type[OrderExcitation]] = {}
"""Kind -> type, in the order of the kinds, whatever the order in which files were imported."""
T = TypeVar("T", bound="type[OrderExcitation]")


@dataclass(frozen=True, eq=False)
class TorqueShares:
    """Torques that come on top, one or another: each acts on one node.

    Attributes
    ----------
    labels : tuple of str
    nodes : tuple of str
        The node of each.
    amplitudes : (n_shares, n_speeds, n_orders) complex array
        N m, peak values.
    parts : tuple of str
        The part of the machine that each is of: a part that misfires does not scatter.
    """

    labels: tuple[str, ...]
    nodes: tuple[str, ...]
    amplitudes: ComplexArray
    parts: tuple[str, ...]


@dataclass(frozen=True, eq=False)
class OrderTorques:
    """Torques on nodes, T(t) = Re sum_i T_i exp(j (h_i phi + 2 pi f_i t)), phi the angle of the shaft.

    A torque drives the shaft it is on where it is positive. Excitations that impose a motion give that instead: angles
    of nodes in the sense in which they turn, or twists: how far the shaft of the excitation, where it enters the
    element, is ahead of what its springs would have it, in rad of that shaft.

    Attributes
    ----------
    orders : (n_lines,) array
        Vibrations per revolution of the shaft; 0 where a line does not follow the speed.
    nodes : tuple of str
        Where it acts: nodes, or elements whose twist is imposed.
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
    """Base of the excitations; a class of its own for each ``type:``, registered by :func:`register_excitation`."""

    article: ClassVar[str] = "an excitation"

    enabled: bool = entry(Flag("whether it acts before a configuration says otherwise"), True)

    @classmethod
    def _is_common(cls, declared: Field[Any]) -> bool:
        return declared.name == "enabled"

    @property
    def shaft(self) -> str:
        """A node of the shaft whose revolutions the orders count."""
        raise NotImplementedError

    @property
    def quantity(self) -> str:
        """What it gives: ``torque`` on nodes, ``angle`` of nodes or ``twist`` of elements."""
        return "torque"

    @property
    def node_entries(self) -> tuple[tuple[Path, str], ...]:
        """Where the nodes it acts on are named, and their names."""
        return ()

    @property
    def element_entry(self) -> tuple[Path, str] | None:
        """Where the element is named whose twist it imposes, and its name."""
        return None

    @property
    def nodes(self) -> tuple[str, ...]:
        """Where it acts, every node once."""
        return tuple(dict.fromkeys(node for _, node in self.node_entries))

    @property
    def reaction_entry(self) -> tuple[Path, str] | None:
        """Where the node is named that takes the opposite of all torques, or that motions are relative to; its name."""
        return None

    @property
    def reaction_node(self) -> str | None:
        """That node, where it is not the ground."""
        return None if self.reaction_entry is None else self.reaction_entry[1]

    @property
    def crankshaft(self) -> frozenset[str]:
        """Nodes of the crankshaft whose angle its torques count from; none for what has no pistons."""
        return frozenset()

    @property
    def is_phased(self) -> bool:
        """Whether the angle of its crankshaft to that of the first engine is given."""
        return False

    @property
    def absorbs(self) -> bool:
        """Whether its gas takes work, as that of a compressor does."""
        return False

    def channel(self, place: str) -> Input:
        """The input that it is at one of its nodes or elements."""
        return Input(self.quantity, place, self.reaction_node)

    def fitted(self, elements: Mapping[str, Element]) -> Self:
        """With what the elements it names know: a shaft, a number of teeth."""
        del elements
        return self

    def misfits(self, elements: Mapping[str, Element]) -> list[Fault]:
        """Faults of entries that do not fit the element it names, which is there."""
        del elements
        return []

    def torques(self, speeds: FloatArray) -> OrderTorques:
        """What acts at speeds of its shaft, rad/s."""
        raise NotImplementedError

    def phase_vectors(self, order: float) -> dict[str, tuple[str, complex]]:
        """What acts with a phase of its own: its node and ``exp(-j order alpha)``, or 0 where it is out of action."""
        del order
        return {node: (node, 1.0 + 0j) for node in self.nodes}

    @property
    def rating(self) -> Rating | None:
        """The mean torque it states, with the speed to which that belongs."""
        return None

    def remarks(self, speeds: FloatArray | None) -> list[Fault]:
        """What is wrong at speeds of its shaft in rad/s, where these are known, and what is worth a warning or note."""
        del speeds
        return []


@dataclass(frozen=True, kw_only=True)
class ReactingExcitation(OrderExcitation):
    """Base of those whose torques may act between two nodes: a crankshaft and the block, a pump and its housing."""

    reaction: str | None = entry(
        NodeName(
            "the node that takes the opposite torques, or that an imposed motion is relative to; default: the ground",
            allow_ground=False,
        ),
        None,
    )

    @property
    def reaction_entry(self) -> tuple[Path, str] | None:
        return (("reaction",), self.reaction) if self.reaction else None

    def contradictions(self) -> list[Fault]:
        if self.reaction not in self.nodes:
            return []
        text = f'"{self.reaction}" takes the opposite of a torque on itself; name the node of what it reacts on'
        return [Fault(text, ("reaction",))]


def register_excitation(cls: T) -> T:
    """Make a type known by its ``kind``."""
    known: dict[str, type[OrderExcitation]] = {**_KINDS, cls.kind: cls}
    _KINDS.clear()
    _KINDS.update(sorted(known.items()))
    return cls


def excitation_kinds() -> Mapping[str, type[OrderExcitation]]:
    """The types of excitation by the word in ``type:``."""
    return _KINDS
