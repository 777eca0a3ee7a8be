"""What every excitation by order has: the shaft it runs with, and torques on nodes by order of that shaft."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar, TypeVar

import numpy as np
from numpy.typing import NDArray

from torsionnet.core.entries.declared import Declared

FloatArray = NDArray[np.float64]
ComplexArray = NDArray[np.complex128]

_KINDS: dict[str, type[OrderExcitation]] = {}
T = TypeVar("T", bound="type[OrderExcitation]")


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
    """

    orders: FloatArray
    nodes: tuple[str, ...]
    amplitudes: ComplexArray


class OrderExcitation(Declared):
    """Base of the excitations; a class of its own for each ``type:``, registered by :func:`register_excitation`."""

    article: ClassVar[str] = "an excitation"

    speed_of: Any
    """The node of the shaft whose revolutions the orders count."""

    @property
    def nodes(self) -> tuple[str, ...]:
        """Where it acts."""
        raise NotImplementedError

    def torques(self, speeds: FloatArray) -> OrderTorques:
        """The torques at speeds of its shaft, rad/s."""
        raise NotImplementedError


def register_excitation(cls: T) -> T:
    """Make a type known by its ``kind``."""
    _KINDS[cls.kind] = cls
    return cls


def excitation_kinds() -> Mapping[str, type[OrderExcitation]]:
    """The types of excitation by the word in ``type:``."""
    return _KINDS
