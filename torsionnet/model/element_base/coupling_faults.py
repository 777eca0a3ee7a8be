"""Faults of a flexible coupling whose entries contradict each other."""

from __future__ import annotations

from typing import Any

from torsionnet.base.entries.composite import given_entries, one_at_most, superfluous
from torsionnet.base.errors import Fault
from torsionnet.base.expressions import RATIONAL
from torsionnet.model.damping import DampingMeasure, loss_factor
from torsionnet.model.element_base.curves import is_share
from torsionnet.model.element_base.viscoelastic import temperature_faults

_READ_AT = {
    "stiffness_over_torque": "torque",
    "torque_factor": "torque",
    "amplitude_factor": "vibratory_torque",
    "temperature_factor": "temperature",
    "damping_temperature_factor": "temperature",
}
"""Name of the entry with the operating value at which each curve of a coupling is read, by the curve's entry."""
_OVER_FREQUENCY = ("frequency_factor", "loss_over_frequency")


def given_curves(coupling: Any) -> list[tuple[str, str]]:
    """Entry name of every curve that a coupling gives, and of the operating value at which the curve is read."""
    return [(name, operating) for name, operating in _READ_AT.items() if getattr(coupling, name)]


def contradictions(coupling: Any) -> list[Fault]:
    """Faults of a coupling in the source of its stiffness, or, where that is clear, in its other entries."""
    found = _source_faults(coupling)
    if found or coupling.material is not None:
        return found or _material_faults(coupling)
    return [
        *_curve_faults(coupling),
        *_damping_faults(coupling),
        *_frequency_faults(coupling),
    ]


def _source_faults(coupling: Any) -> list[Fault]:
    sources = ("stiffness", "stiffness_over_torque", "material")
    found = given_entries(coupling, *sources)
    if not found:
        return [Fault("give stiffness, stiffness_over_torque, or material and geometry", on_key=True)]
    if len(found) > 1:
        return one_at_most(coupling, *sources, of="the stiffness")
    if (coupling.material is None) != (coupling.geometry is None):
        lacking = "geometry, as {type: disc, ...}" if coupling.material is not None else "material, as {moduli: ...}"
        return [Fault(f"stiffness from rubber needs material and geometry; here is no {lacking}", on_key=True)]
    return []


def _material_faults(coupling: Any) -> list[Fault]:
    others = [*_READ_AT, *_OVER_FREQUENCY, "loss_factor"]
    own = next((name for name in others if getattr(coupling, name)), None)
    if own is not None:
        return [superfluous("the material gives stiffness and damping already", own)]
    return [*temperature_faults(coupling.material, coupling.temperature), *_frequency_faults(coupling)]


def _curve_faults(coupling: Any) -> list[Fault]:
    faults = []
    found = given_curves(coupling)
    for name, operating in found:
        if getattr(coupling, operating) is None:
            faults.append(Fault(f"{name} needs {operating}, at which it is read", (name,), on_key=True))
        if is_share(getattr(coupling, name)[0][0]) and coupling.T_KN is None and operating != "temperature":
            text = "rows without a unit are shares of the nominal torque: give T_KN, or torques in N*m"
            faults.append(Fault(text, (name,), on_key=True))
    for operating in dict.fromkeys(_READ_AT.values()):
        if getattr(coupling, operating) is not None and operating not in {where for _, where in found}:
            curves = " or ".join(name for name, where in _READ_AT.items() if where == operating)
            faults.append(
                Fault(f"nothing here depends on {operating}; give {curves}, or leave it out", (operating,), on_key=True)
            )
    return faults


def _damping_faults(coupling: Any) -> list[Fault]:
    both = one_at_most(coupling, "loss_factor", "damping", "loss_over_frequency", of="the damping")
    if both:
        return both
    if coupling.damping_temperature_factor and coupling.loss_factor is None:
        text = "this factor multiplies loss_factor, which is not given; add loss_factor"
        return [Fault(text, ("damping_temperature_factor",), on_key=True)]
    if coupling.frequency_factor and not (coupling.loss_over_frequency or _loses(coupling.loss_factor)):
        text = "a stiffness over frequency needs a damping, too: loss_factor or loss_over_frequency"
        return [Fault(text, ("frequency_factor",), on_key=True)]
    return []


def _loses(entry: Any) -> bool:
    """Whether a loss factor is above zero, or may be, as parameters give it."""
    return entry is not None and bool(entry.names or loss_factor(entry, {}, RATIONAL) > 0)


def _frequency_faults(coupling: Any) -> list[Fault]:
    """Faults of a coupling's damping that laws over frequency cannot take.

    Their loss is made of numbers: parameters in it would be without derivatives in fits.
    """
    if coupling.material is not None and isinstance(coupling.damping, DampingMeasure):
        return [Fault("beside a material the damping is a viscous coefficient; give it in N*m*s/rad", ("damping",))]
    if coupling.material is None and coupling.scale is not None:
        return [
            Fault(
                "scale multiplies the moduli of a material, which is not given; add material, or leave it out",
                ("scale",),
                on_key=True,
            )
        ]
    if not coupling.frequency_factor:
        return []
    names = ["loss_factor", *(["temperature"] if coupling.damping_temperature_factor else [])]
    return [
        Fault(f"with curves over frequency {name} must be a number, not an expression of parameters", (name,))
        for name in names
        if getattr(getattr(coupling, name), "names", ())
    ]
