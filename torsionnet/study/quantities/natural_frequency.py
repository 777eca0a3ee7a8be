"""Natural frequency and damping ratio of a mode tracked from variant to variant, two quantities of a study."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from typing import ClassVar

import numpy as np

from torsionnet.base.entries.spec import Count, OneOf, entry
from torsionnet.base.errors import Fault, UsageError
from torsionnet.drivetrain import Drivetrain
from torsionnet.linear.assembly.rows import ComplexArray, FloatArray
from torsionnet.linear.modes.modes import OSCILLATORY, Modes
from torsionnet.study.quantities.quantity import (
    QuantityForm,
    StudyQuantity,
    VariantBlock,
    nominal_modes,
    register_quantity,
)

TRACKED, ASCENDING = "tracked", "ascending"
MIXED = "veers: a fifth or more of its energy is that of another mode of the model"


@dataclass(frozen=True, kw_only=True)
class ModeQuantity(StudyQuantity):
    """Base class of the quantities of one mode of vibration (natural frequency, damping ratio).

    ``tracked``, the default, is the mode of every variant whose shape is that of the nominal mode of this number, by
    the modal assurance criterion, wherever its frequency has gone; ``ascending`` the one of this number by size.
    """

    kind: ClassVar[str] = "mode"

    mode: int = entry(Count("1 is the lowest vibration; rigid bodies and overdamped motions do not count"))
    order: str | None = entry(
        OneOf(
            "the mode that the nominal one becomes, or the n-th by frequency; default: tracked", (TRACKED, ASCENDING)
        ),
        None,
    )

    def model_faults(self, model: Drivetrain, quantities: Mapping[str, StudyQuantity]) -> Iterator[Fault]:
        del quantities
        yield from self.missing_mode_faults(len(vibrating(nominal_modes(model))))

    @property
    def which_mode(self) -> str:
        """Words for the mode, such as "mode 2 by frequency"."""
        if self.order == ASCENDING:
            return f"mode {self.mode} by frequency"
        return f"mode {self.mode}, followed by its shape"

    def missing_mode_faults(self, count: int) -> Iterator[Fault]:
        """Yield a fault where the model has only ``count`` modes of vibration and the quantity names a higher one."""
        if self.mode > count:
            there = f"{count} mode{'s' * (count != 1)} of vibration" if count else "no mode of vibration"
            yield Fault(f"there is no mode {self.mode}; the model has {there}", ("mode",), kind="unknown-mode")

    def eigenvalue(self, block: VariantBlock) -> ComplexArray:
        """Eigenvalues (n_variants,), complex, in rad/s of the mode; NaN where a variant has no such vibration."""
        if self.order == ASCENDING:
            return nth_vibration(block.read_modes.eigenvalues, self.mode)
        place = vibrating(block.modes.reference)[self.mode - 1]
        mixed = int(np.sum(block.modes.veering[:, place]))
        if mixed:
            block.remark(f"mode {self.mode} {MIXED}", mixed)
        chosen = block.modes.eigenvalues[:, place]
        return np.where(chosen.imag > 0, chosen, complex(np.nan, np.nan))


def nth_vibration(eigenvalues: ComplexArray, number: int) -> ComplexArray:
    """Eigenvalue (n_variants,) in rad/s of the n-th vibration by magnitude among (n_variants, n_modes), or NaN."""
    vibrates = eigenvalues.imag > 0
    # What does not vibrate comes last.
    places = np.argsort(np.where(vibrates, np.abs(eigenvalues), np.inf), axis=1, kind="stable")
    if places.shape[1] < number:
        return np.full(len(eigenvalues), complex(np.nan, np.nan))
    place = places[:, number - 1 : number]
    vibration = np.take_along_axis(eigenvalues, place, axis=1)[:, 0]
    return np.where(np.take_along_axis(vibrates, place, axis=1)[:, 0], vibration, complex(np.nan, np.nan))


def vibrating(modes: Modes) -> list[int]:
    """Indices of the modes of vibration among all modes of a model, by rising ``|lambda|``."""
    return [place for place, kind in enumerate(modes.kinds) if kind == OSCILLATORY]


UNDAMPED = "undamped"
WORDS = {"natural": "natural frequency", "damped": "frequency of the damped vibration"}


@register_quantity
@dataclass(frozen=True, kw_only=True)
class NaturalFrequency(ModeQuantity):
    """Frequency in Hz of a mode, natural ``|lambda|/2pi``, damped ``Im lambda/2pi``, or undamped, of M and K alone.

    Undamped ones are followed by their place among all by size: that of the mode of this number in the nominal model.
    """

    kind: ClassVar[str] = "natural_frequency"

    which: str = entry(OneOf("|lambda|/2pi, Im lambda/2pi, or without damping", ("natural", "damped", UNDAMPED)),
                       "natural")  # fmt: skip

    def contradictions(self) -> list[Fault]:
        if self.which == UNDAMPED and self.order not in (None, ASCENDING):
            return [
                Fault(
                    "undamped natural frequencies are counted by size: order is ascending",
                    ("order",),
                    kind="contradicting-entries",
                )
            ]
        return []

    def model_faults(self, model: Drivetrain, quantities: Mapping[str, StudyQuantity]) -> Iterator[Fault]:
        if self.which != UNDAMPED:
            yield from super().model_faults(model, quantities)
        else:
            from torsionnet.linear.modes.mode_pairs import undamped_place

            try:
                undamped_place(model, self.mode)
            except UsageError as error:
                yield replace(error.fault, path=("mode",))

    @property
    def words(self) -> str:
        if self.which == UNDAMPED:
            return f"undamped natural frequency number {self.mode}"
        return f"{WORDS[self.which]} of {self.which_mode}"

    def measure(self, model: Drivetrain) -> QuantityForm:
        del model
        return QuantityForm("Hz")

    def evaluate(self, block: VariantBlock) -> FloatArray:
        if self.which == UNDAMPED:
            return self.undamped(block)
        eigenvalue = self.eigenvalue(block)
        size = np.abs(eigenvalue) if self.which == "natural" else eigenvalue.imag
        return np.asarray(size[:, None] / (2 * np.pi))

    def undamped(self, block: VariantBlock) -> FloatArray:
        """Undamped natural frequencies (n_variants, 1) in Hz, at the nominal mode's place among those above 0."""
        from torsionnet.linear.modes.mode_pairs import undamped_place

        place, _ = undamped_place(block.model, self.mode)
        return nth_above_zero(block.read_modes.undamped_natural_frequencies, place + 1)


def nth_above_zero(sizes: FloatArray, number: int) -> FloatArray:
    """Value (n, 1) of the n-th smallest above 0 in every row of values (n, n_values), or NaN.

    NaN where there are fewer.
    """
    rising = np.sort(np.where(sizes > 0, sizes, np.inf), axis=1)
    if rising.shape[1] < number:
        return np.full((len(sizes), 1), np.nan)
    chosen = rising[:, number - 1 : number]
    return np.where(np.isfinite(chosen), chosen, np.nan)


@register_quantity
@dataclass(frozen=True, kw_only=True)
class DampingRatio(ModeQuantity):
    """Damping ratio ``-Re lambda/|lambda|`` (unit 1) of a vibration mode."""

    kind: ClassVar[str] = "damping_ratio"

    @property
    def words(self) -> str:
        return f"damping ratio of {self.which_mode}"

    def measure(self, model: Drivetrain) -> QuantityForm:
        del model
        return QuantityForm()

    def evaluate(self, block: VariantBlock) -> FloatArray:
        eigenvalue = self.eigenvalue(block)
        return np.asarray((-eigenvalue.real / np.abs(eigenvalue))[:, None])
