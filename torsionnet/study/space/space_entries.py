"""Entries of a study file that say what varies, on parameters, their correlation and their sampling."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar

from torsionnet.base.entries.composite import Listed, Named, Nested, Typed
from torsionnet.base.entries.declared import Declared
from torsionnet.base.entries.spec import entry
from torsionnet.study.space.correlation import Correlation
from torsionnet.study.space.samples import Samples
from torsionnet.study.space.variations.variation import VARIATIONS, Variation

VARY = Named(
    "what varies, by name: parameters, and values of elements (shaft.stiffness)",
    Typed(
        "how a parameter varies", lambda: VARIATIONS, "variation", "variation", shown="{type: normal, deviation: 5 %}"
    ),
    form="parameters and how they vary, k_1: {type: normal, deviation: 5 %}",
    fewest=1,
)
CORRELATION = Listed(
    "which parameters vary together",
    Nested("parameters that vary together", lambda: Correlation, "correlation"),
    form="a list of {between: [k_1, k_2], coefficient: 0.6}",
)
SAMPLING = Nested("how variants are drawn", lambda: Samples, "sampling", shown=Samples.form)


@dataclass(frozen=True, kw_only=True)
class SpaceEntries(Declared):
    """Varied parameters of a study, their correlation and their sampling."""

    kind: ClassVar[str] = "space"
    article: ClassVar[str] = "a space of variants"
    form: ClassVar[str] = "{vary: {k_1: {type: normal, deviation: 5 %}}, sampling: {count: 1000}}"

    vary: Mapping[str, Variation] = entry(VARY)
    correlation: tuple[Correlation, ...] = entry(CORRELATION, ())
    sampling: Samples | None = entry(SAMPLING, None)
