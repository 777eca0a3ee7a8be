"""What every excitation by order has: the shaft it runs with, and torques on nodes by order of that shaft."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar, TypeVar

import numpy as np
from numpy.typing import NDArray

from torsionnet.core.entries.declared import Declared
from torsionnet.core.entries.scalars import Value
from torsionnet.core.errors import Fault, Path

ORDER = Value("vibrations per revolution", "1", exclusive=True, below=10_000)
FloatArray = NDArray[np.float64]
ComplexArray = NDArray[np.complex128]

_KINDS: dict[str, type[OrderExcitation]] = {}
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
    """Torques on nodes, T(phi) = Re sum_h T_h exp(j h phi), phi the angle of the shaft, driving where positive.

    Attributes
    ----------
    orders : (n_orders,) array
        Vibrations per revolution of the shaft.
    nodes : tuple of str
    amplitudes : (n_speeds, n_orders, n_nodes) complex array
        N m, peak values.
    alternatives : TorqueShares, optional
        One of these comes on top, whichever is worst.
    scatter : TorqueShares, optional
        All of these come on top with factors from -1 to 1, in the worst combination.
    """

    orders: FloatArray
    nodes: tuple[str, ...]
    amplitudes: ComplexArray
    alternatives: TorqueShares | None = None
    scatter: TorqueShares | None = None


@dataclass(frozen=True, kw_only=True)
class OrderExcitation(Declared):
    """Base of the excitations; a class of its own for each ``type:``, registered by :func:`register_excitation`."""

    article: ClassVar[str] = "an excitation"

    @property
    def shaft(self) -> str:
        """A node of the shaft whose revolutions the orders count."""
        raise NotImplementedError

    @property
    def node_entries(self) -> tuple[tuple[Path, str], ...]:
        """Where the nodes it acts on are named, and their names."""
        raise NotImplementedError

    @property
    def nodes(self) -> tuple[str, ...]:
        """Where it acts, every node once."""
        return tuple(dict.fromkeys(node for _, node in self.node_entries))

    def torques(self, speeds: FloatArray) -> OrderTorques:
        """The torques at speeds of its shaft, rad/s."""
        raise NotImplementedError

    def remarks(self, speeds: FloatArray | None) -> list[Fault]:
        """What is wrong at speeds of its shaft in rad/s, where these are known, and what is worth a warning or note."""
        del speeds
        return []


def register_excitation(cls: T) -> T:
    """Make a type known by its ``kind``."""
    _KINDS[cls.kind] = cls
    return cls


def excitation_kinds() -> Mapping[str, type[OrderExcitation]]:
    """The types of excitation by the word in ``type:``."""
    return _KINDS
