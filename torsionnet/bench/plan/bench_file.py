"""Bench file, which names a model and describes a test of it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from torsionnet.base.entries.composite import Nested
from torsionnet.base.entries.declared import KEY, Declared
from torsionnet.base.entries.spec import MODEL_NAME, Text, entry
from torsionnet.bench.plan.plan import Plan
from torsionnet.model.configurations import ConfigurationName

_PLAN = Nested("a virtual test: excitation, exciter, sensors, data acquisition", lambda: Plan, "bench")


@dataclass(frozen=True, kw_only=True)
class BenchFile(Declared):
    """A test bench that names its model."""

    kind: ClassVar[str] = "bench file"
    article: ClassVar[str] = "a bench file"
    head: ClassVar[tuple[str, ...]] = (KEY,)

    name: str = entry(Text("title of the test"), "")
    source: str = entry(Text("where the numbers come from"), "")
    description: str = entry(Text("what the test is"), "")
    model: str = entry(
        Text("name of a library model, or path of a model file from the folder of this file", MODEL_NAME)
    )
    configuration: str | None = entry(ConfigurationName("configuration in which the model is tested"), None)
    bench: Plan = entry(_PLAN)
