"""Complex factors on the gas torque by order, with which measured orders correct a trace or a table."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from torsionnet.base.entries.declared import Declared
from torsionnet.base.entries.scalars import Value
from torsionnet.base.entries.spec import entry
from torsionnet.machinery.excitations.order_excitation import ComplexArray, FloatArray


@dataclass(frozen=True, kw_only=True)
class OrderCorrection(Declared):
    """Complex factor on the gas torque of one order: real part, and imaginary part, which leads by 90 degrees."""

    kind: ClassVar[str] = "order correction"
    article: ClassVar[str] = "a correction of an order"
    form: ClassVar[str] = "{real: 1.05, imag: -0.02}"

    real: float = entry(Value("real part of the factor; 1 leaves the order as it is", "1", lower=None), 1)
    imag: float = entry(Value("imaginary part of the factor", "1", lower=None), 0)


def corrections(table: Mapping[float, OrderCorrection], orders: FloatArray) -> ComplexArray:
    """Complex factors without unit on the gas torque at orders, shape (n_orders,); 1 at orders not in the table.

    Examples
    --------
    >>> corrections({3.0: OrderCorrection(real=1.1, imag=0.2)}, np.array([1.5, 3.0])).tolist()
    [(1+0j), (1.1+0.2j)]
    """
    found = np.ones(len(orders), dtype=complex)
    for order, one in table.items():
        found[np.isclose(orders, order)] = complex(one.real, one.imag)
    return found
