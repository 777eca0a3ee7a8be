"""Viscous equivalent of hysteretic and tabulated laws, springs and dampers equal to them at one frequency."""

from __future__ import annotations

from dataclasses import dataclass, replace
from fractions import Fraction
from typing import TypeVar

from torsionnet.base.errors import UsageError
from torsionnet.model.element_base.element import OtherLaws
from torsionnet.model.elements import Law, Part, Values
from torsionnet.model.model import Model

AnyModel = TypeVar("AnyModel", bound=Model)


def viscous_equivalent(model: AnyModel, frequency: float) -> AnyModel:
    """Copy of a model with a spring Re kappa and a damper Im kappa/(2 pi f) in place of each law over frequency.

    At f the copy responds as the model does. Elsewhere its damping is c omega where that of the model was k eta:
    vibrations above f are damped too much and those below too little.

    Parameters
    ----------
    model : Drivetrain
    frequency : float
        Frequency f in Hz above zero, mostly that of the mode in question.

    Raises
    ------
    UsageError
        The frequency is not above zero, or a law is no spring there, as that of a long continuous shaft.

    Examples
    --------
    >>> import torsionnet as tn
    >>> rubber = tn.HystereticSpring("rubber", nodes=("a", "ground"), stiffness=1000, loss_factor=0.1)
    >>> rig = tn.Drivetrain("rig", [tn.Inertia("disc", node="a", inertia=0.5), rubber])
    >>> round(float(viscous_equivalent(rig, 10).assembly.system.C[0, 0]), 6)  # 1000 * 0.1/(2 pi 10)
    1.591549
    """
    if not 0 < frequency < float("inf"):
        raise UsageError(f"a viscous equivalent holds at a frequency above 0 Hz, got {frequency:g}")
    values, elements = Values(model.exact_values), dict(model.definition.elements)
    for name, element in elements.items():
        if any(isinstance(part, Law) and _is_over_frequency(part) for part in element.parts(values)):
            laws = ViscousLaws(element, Fraction(repr(float(frequency))))
            laws.parts(values)  # refuses what has no equivalent
            elements[name] = element.with_laws(laws)
    return model.with_definition(replace(model.definition, elements=elements))


def _is_over_frequency(law: Law) -> bool:
    return law.table is not None or law.loss_factor != 0


@dataclass(frozen=True)
class ViscousLaws(OtherLaws):
    """Laws of an element with constant coefficients at a frequency in Hz."""

    frequency: Fraction

    def parts(self, value: Values) -> tuple[Part, ...]:
        return tuple(
            self._viscous(part, value) if isinstance(part, Law) and _is_over_frequency(part) else part
            for part in self.element.parts(value)
        )

    def _viscous(self, law: Law, value: Values) -> Law:
        omega = value.algebra.pi * value.algebra.number(2 * self.frequency)
        stiffness, lost = law.stiffness, law.stiffness * law.loss_factor
        if law.table is not None:
            import numpy as np

            table = law.table.with_coefficients(*map(float, law.table.coefficients))
            kappa = complex(table.kappa(np.array([2 * np.pi * float(self.frequency)]))[0])
            if kappa.real < 0:
                at = f"{self.element.name}: at {float(self.frequency):g} Hz the stiffness is {kappa.real:.6g} N m/rad"
                rest = "a continuous shaft may be given as type: shaft with segments"
                raise UsageError(f"{at}, which no spring has; {rest}")
            stiffness = stiffness + value.algebra.number(Fraction(kappa.real))
            lost = lost + value.algebra.number(Fraction(kappa.imag))
        return replace(law, stiffness=stiffness, damping=law.damping + lost / omega, loss_factor=0, table=None)
