"""Torque converter: pump and turbine torque by tables over the speed ratio."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from torsionnet.base.entries.scalars import RowColumn
from torsionnet.base.entries.spec import entry
from torsionnet.base.expressions import Rows
from torsionnet.model.element_base.characteristic import Characteristic
from torsionnet.model.element_base.element import register
from torsionnet.model.element_base.hydrodynamic import SPEED_RATIO_COLUMN, Hydrodynamic
from torsionnet.model.element_base.hydrodynamic_curve import Gain
from torsionnet.model.element_base.laws import Values


@register
@dataclass(frozen=True, eq=False, repr=False)
class TorqueConverter(Hydrodynamic):
    """A hydrodynamic torque converter: T_p = C(nu) omega_p^2 and T_t = mu(nu) T_p, nu = omega_t / omega_p.

    With E = mu C and slopes over nu, small changes of the speeds change the torques by
    dT_p = omega_p (2 C - nu C') domega_p + omega_p C' domega_t and
    dT_t = omega_p (2 E - nu E') domega_p + omega_p E' domega_t: a matrix that is not symmetric. The stator takes the
    difference to the housing. C is given as for ``fluid_coupling``: by the performance coefficient lambda(nu) of
    C = lambda rho D^5, by the pump torque at a test speed (as MP2000 curves at 2000 r/min), or by the K factor
    omega_p / sqrt(T_p). Both tables are straight between their rows; at a row the piece above it counts. A lock-up
    clutch is a ``clutch`` beside it (A. J. Kotwicki, Dynamic models for torque converter equipped vehicles, SAE 820393,
    1982).

    T_p and T_t are its laws of motion in time, over absolute speeds. Without ``speed`` and ``speed_ratio`` linear
    results take their slopes at the operating point; without one the converter stands and passes on nothing.

    Examples
    --------
    >>> converter = TorqueConverter("converter", pump="engine", turbine="input", speed="2000 rpm", speed_ratio=0.5,
    ...     pump_torque=[[0, "180 N*m"], [1, "100 N*m"]], test_speed="2000 rpm", torque_ratio=[[0, 2.2], [1, 1]])
    >>> pump_slope = float(converter.parts(Values({}))[0].damping)
    >>> round(pump_slope, 4)  # 80 N*m over 2000 r/min
    0.382
    """

    kind: ClassVar[str] = "torque_converter"
    more_tables: ClassVar[tuple[str, ...]] = ("torque_ratio",)

    torque_ratio: Rows = entry(
        Characteristic(
            "rows [speed ratio, turbine torque over pump torque]", (SPEED_RATIO_COLUMN, RowColumn("torque ratio"))
        ),
        kw_only=True,
    )

    def gain(self, value: Values) -> Gain:
        return Gain(self.torque_ratio, value.algebra)
