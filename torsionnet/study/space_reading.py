"""Variations bound to the values of a model, or everything that is wrong with them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from torsionnet.core.errors import Fault, unknown_name
from torsionnet.core.expressions import Expression
from torsionnet.model.model import Model
from torsionnet.response.frequency_response import FloatArray
from torsionnet.study.correlation import Correlation, name_faults
from torsionnet.study.correlation_matrix import normal_correlation
from torsionnet.study.joint_distribution import JointDistribution
from torsionnet.study.reachable import unreachable
from torsionnet.study.samples import Samples
from torsionnet.study.variations.grid_axis import GridAxis
from torsionnet.study.variations.marginal import Marginal
from torsionnet.study.variations.nominal import NominalReader, nominals
from torsionnet.study.variations.variation import Variation


@dataclass(frozen=True, eq=False)
class BoundSpace:
    """What varies in SI.

    Attributes
    ----------
    nominal : mapping
        Values in the model; NaN where it has none.
    joint : JointDistribution
        Of parameters with a distribution.
    axes : mapping
        Of parameters with values on a grid.
    """

    nominal: Mapping[str, float]
    joint: JointDistribution
    axes: Mapping[str, GridAxis]


def bound_space(
    vary: Mapping[str, Variation], correlation: Sequence[Correlation], sampling: Samples | None, model: Model
) -> tuple[BoundSpace | None, list[Fault]]:
    """The space in SI, None if there is an error, and all findings."""
    faults = [_unknown(name, model) for name in vary if name not in model.parameters]
    known = nominals(model, [name for name in vary if name in model.parameters])
    marginals: dict[str, Marginal] = {}
    axes: dict[str, GridAxis] = {}
    for name, nominal in known.items():
        reader = NominalReader(nominal)
        found = vary[name].bound(reader)
        faults += [fault.under("vary", name) for fault in reader.faults]
        if isinstance(found, Marginal):
            marginals[name] = found
        elif found is not None:
            axes[name] = found
    faults += unreachable(model, marginals, axes)
    faults += [fault.under("sampling") for fault in _sampling_faults(vary, sampling)]
    root, wrong = _root(vary, correlation, marginals)
    faults += [fault.under("correlation") for fault in wrong]
    if any(fault.severity == "error" for fault in faults):
        return None, faults
    values = {name: np.nan if one.value is None else one.value for name, one in known.items()}
    return BoundSpace(values, JointDistribution(marginals, root), axes), faults


def _unknown(name: str, model: Model) -> Fault:
    path = ("vary", name)
    if name in model.axes:
        alternatives = ", ".join(model.axes[name])
        text = f'"{name}" is no parameter but an axis of configurations; a study takes these as configurations:'
        return Fault(f"{text} {alternatives}", path, on_key=True, kind="unknown name", about=name)
    element, _, key = name.rpartition(".")
    if element in model.definition.elements:
        value = dict(model.definition.elements[element].scalars()).get(key, (None, None))[1]
        if isinstance(value, Expression):
            used = ", ".join(sorted(value.names))
            rest = f'its {key} is "{value}"; vary {used}' if used else f"name its {key} under parameters: to vary it"
            text = f'"{name}" is an entry of an element, and only parameters vary; {rest}'
            return Fault(text, path, on_key=True, kind="unknown name", about=name, meant=used)
    return unknown_name("parameter", name, model.parameters, path, on_key=True)


def _sampling_faults(vary: Mapping[str, Variation], sampling: Samples | None) -> list[Fault]:
    if sampling is None:
        return []
    remark = sampling.remark()
    faults = [] if remark is None else [remark]
    if not any(one.is_random for one in vary.values()):
        text = "nothing is drawn: all parameters take the values of a list or range; leave sampling out"
        faults.append(Fault(text, on_key=True))
    return faults


def _root(
    vary: Mapping[str, Variation], correlation: Sequence[Correlation], marginals: Mapping[str, Marginal]
) -> tuple[FloatArray | None, list[Fault]]:
    random = [name for name, one in vary.items() if one.is_random]
    faults = name_faults(correlation, random, [name for name in vary if name not in random])
    are_bound = all(name in marginals for one in correlation for name in one.between)
    if faults or not correlation or not are_bound:
        return None, faults
    matrix, faults = normal_correlation(correlation, marginals)
    return (None if faults else np.asarray(np.linalg.cholesky(matrix), dtype=float)), faults
