"""Fluid coupling: torque by a table over the speed ratio."""

from __future__ import annotations

from typing import ClassVar

from torsionnet.model.element_base.element import register
from torsionnet.model.element_base.hydrodynamic import Hydrodynamic


@register
class FluidCoupling(Hydrodynamic):
    """A fluid (Foettinger) coupling: pump and turbine pass on one torque T = C(nu) omega_p^2, nu = omega_t / omega_p.

    C is lambda rho D^5 with the performance coefficient lambda(nu), the torque at a test speed over its square, or
    1/K^2 with the K factor omega_p / sqrt(T). Small changes of the speeds change it by dT = omega_p (2 C - nu C')
    domega_p + omega_p C' domega_t: a damper -omega_p C' between pump and turbine, and a torque omega_p (2 C + (1 - nu)
    C') on both that follows the speed of the pump alone, so that the coupling acts one way more than the other. Tables
    are straight between their rows; at a row the piece above it counts. The oil follows without delay here, and what
    of it turns along belongs to the inertias (VDI 2153, Hydrodynamic power transmission).

    T is its law of motion in time, over absolute speeds. Without ``speed`` and ``speed_ratio`` linear results take its
    slopes at the operating point; without one the coupling stands and passes on nothing.

    Examples
    --------
    >>> from torsionnet.model.element_base.laws import Values
    >>> coupling = FluidCoupling("coupling", pump="a", turbine="b", speed="150 rad/s", speed_ratio=0.97,
    ...     pump_torque=[[0.9, "900 N*m"], [1, 0]], test_speed="150 rad/s")
    >>> damper, follows = coupling.parts(Values({}))
    >>> float(damper.damping), [float(value) for value in follows.numerator]
    (60.0, [0.0, 1.8])
    """

    kind: ClassVar[str] = "fluid_coupling"
