"""Order torque, a quantity of a study, the vibration of a torque, twist or stress over the machinery's speeds."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from math import isclose
from typing import ClassVar, TypeAlias

import numpy as np
from numpy.typing import NDArray

from torsionnet.base.entries.scalars import Value
from torsionnet.base.entries.spec import Flag, OneOf, Text, entry
from torsionnet.base.errors import Fault
from torsionnet.drivetrain import Drivetrain
from torsionnet.linear.assembly.rows import FloatArray
from torsionnet.linear.dynamic_stiffness.transfer_request import cached_request, named_output
from torsionnet.machinery.criticals.line_meetings import around_poles
from torsionnet.machinery.orders.order_response import NOT_MET, OrderResponse
from torsionnet.machinery.orders.order_solution import OrderRequest
from torsionnet.machinery.orders.refined_response import is_periodic
from torsionnet.machinery.orders.speed_refinement import fill_speed_gaps, new_speeds, refine_speeds, speeds_to_refine
from torsionnet.study.quantities.quantity import QuantityForm, StudyQuantity, VariantBlock, register_quantity
from torsionnet.study.quantities.transfer_quantity import SpeedQuantity, usage_faults

# Order responses of many variants, and their largest values over a range of speeds, whatever the step of speeds.


def order_responses(
    block: VariantBlock, output: str, speeds: FloatArray, excitations: Sequence[str] | None = None
) -> Iterator[tuple[int, OrderResponse]]:
    """Yield the number and order response of every variant that has one.

    Variants whose parameters follow the operating point are solved one by one, at every speed with its own values.
    """
    question = common_request(block, speeds, excitations)
    if question is None:
        for index in range(len(block)):
            run = _single(block, index, output, speeds, excitations)
            if run is not None:
                yield index, run
        return
    loads = question.loads(speeds)
    channels = tuple(read.channel for read in cached_request(block.model, output, list(loads.inputs), None).outputs)
    frequencies = loads.frequencies
    moving = frequencies[frequencies > 0]
    for which, part in block.parts(len(moving) * len(loads.inputs)):
        solved = part.responses(output, loads.inputs, moving)
        for index, values in zip(range(which.start, which.stop), solved, strict=False):
            # Lines of 0 Hz are mean values and have no response here.
            gains = np.zeros((len(frequencies), *values.shape[1:]), dtype=complex)
            gains[frequencies > 0] = values
            yield index, loads.response(loads.at_lines(frequencies, gains), channels)


def _single(
    block: VariantBlock, index: int, output: str, speeds: FloatArray, excitations: Sequence[str] | None,
    *, refine: bool = False,
) -> OrderResponse | None:  # fmt: skip
    """Order response of one variant by itself, None without one; a motion that is not stable is remarked on."""
    run = block.call(
        index, lambda model: model.order_response(output, speeds=speeds, excitation=excitations, refine=refine)
    )
    if run is not None and run.unmet.any():
        block.remark(f"{output}: {NOT_MET}")
    return run


def responses_at(
    block: VariantBlock, output: str, question: OrderRequest, speeds: Sequence[FloatArray]
) -> Iterator[OrderResponse]:
    """Yield the order response of each variant at its own speeds in rad/s."""
    loads = [question.loads(own) for own in speeds]
    moving = [load.frequencies[load.frequencies > 0] for load in loads]
    longest = max(map(len, moving))
    # Rows have one length: the last frequency again and again where there are fewer.
    frequencies = np.stack([np.append(own, np.full(longest - len(own), own[-1])) for own in moving])
    inputs = loads[0].inputs
    channels = tuple(reading.channel for reading in cached_request(block.model, output, list(inputs), None).outputs)
    first = 0
    for _, part in block.parts(longest * len(inputs)):
        count = len(part)
        solved = part.responses(output, inputs, frequencies[first : first + count])
        for number, values in enumerate(solved, first):
            every = loads[number].frequencies
            gains = np.zeros((len(every), *values.shape[1:]), dtype=complex)
            gains[every > 0] = values[: len(moving[number])]
            yield loads[number].response(loads[number].at_lines(every, gains), channels)
        first += count


def common_request(block: VariantBlock, speeds: FloatArray, excitations: Sequence[str] | None) -> OrderRequest | None:
    """Excitations and speeds (rad/s) that all variants have in common; None where variants differ in them.

    None as well where laws of motion act in full: each variant has motions of its own.
    """
    if block.batch is None or block.model.definition.follows_speed or is_periodic(block.model, None):
        return None
    question = OrderRequest.of(block.model, speeds, excitations=excitations)
    return question if question.drivetrain is block.model else None


Sizes: TypeAlias = Callable[[OrderResponse], FloatArray]
"""Function from an order response to its size at each speed (n_speeds,), such as half the range."""


def largest_orders(
    block: VariantBlock, output: str, speeds: FloatArray, excitations: Sequence[str] | None, sizes: Sizes
) -> Iterator[tuple[int, float]]:
    """Yield the number of each variant with an order response, and the largest of its sizes over the speeds.

    Variants whose parameters follow the operating point are solved one by one.
    """
    question = common_request(block, speeds, excitations)
    if question is None or len(speeds) < 2:
        several = len(speeds) > 1
        for index in range(len(block)):
            run = _single(block, index, output, speeds, excitations, refine=several)
            if run is not None:
                yield index, float(sizes(run).max())
        return
    first = fill_speed_gaps(speeds)
    places, curves = [], []
    for index, run in order_responses(block, output, first, excitations):
        places.append(index)
        curves.append(_Curve(first, sizes(run)))
    search = _Search(block, output, question, sizes, np.array(places, dtype=np.intp))
    lines = question.loads(first[:1]).lines
    poles = block.every_mode.eigenvalues
    # More speeds of each variant where lines pass its own poles.
    around = [
        new_speeds(first, around_poles(poles[index][np.isfinite(poles[index])], lines, first)) for index in places
    ]
    refined = refine_speeds(search.looked(curves, around), _all_wanted, search.looked)
    yield from ((index, float(curve.values.max())) for index, curve in zip(places, refined, strict=True))


@dataclass(frozen=True, eq=False)
class _Curve:
    """Sizes (n_speeds,) of a variant's order response at rising speeds in rad/s."""

    speeds: FloatArray
    values: FloatArray

    def with_more(self, speeds: FloatArray, values: FloatArray) -> _Curve:
        """Curve of a variant's sizes over speed in rad/s, with the sizes at further speeds added."""
        both = np.concatenate([self.speeds, speeds])
        order = np.argsort(both, kind="stable")
        return _Curve(both[order], np.concatenate([self.values, values])[order])


def _all_wanted(curves: Sequence[_Curve]) -> list[FloatArray]:
    """Further speeds in rad/s, an array for each variant, that are needed for its largest size.

    An empty list where no variant needs any.
    """
    further = [speeds_to_refine(curve.speeds, curve.values[:, None]) for curve in curves]
    return further if any(len(speeds) for speeds in further) else []


@dataclass(frozen=True, eq=False)
class _Search:
    """Order responses of several variants at their own speeds, solved together."""

    block: VariantBlock
    output: str
    question: OrderRequest
    sizes: Sizes
    places: NDArray[np.intp]

    def looked(self, curves: list[_Curve], speeds: list[FloatArray]) -> list[_Curve]:
        """Curves of each variant's sizes over speed in rad/s, with the sizes at further speeds added."""
        some = [number for number, those in enumerate(speeds) if len(those)]
        refined = list(curves)
        if some:
            own = self._part(self.places[some])
            runs = responses_at(own, self.output, self.question, [speeds[number] for number in some])
            for number, run in zip(some, runs, strict=True):
                refined[number] = refined[number].with_more(speeds[number], self.sizes(run))
        return refined

    def _part(self, places: NDArray[np.intp]) -> VariantBlock:
        values = {name: column[places] for name, column in self.block.values.items()}
        batch = None if self.block.batch is None else self.block.batch.part(places)
        return replace(self.block, values=values, batch=batch, known={})


SIZES: Mapping[str, Callable[[OrderResponse], FloatArray]] = {
    "half_range": lambda run: run.half_range[:, 0],
    "peak": lambda run: run.peak[:, 0],
    "rms": lambda run: run.rms[:, 0],
}

WORDS = {"half_range": "half of the range", "peak": "largest distance from the mean", "rms": "root mean square"}


@register_quantity
@dataclass(frozen=True, kw_only=True)
class OrderTorque(SpeedQuantity):
    """Vibration of a sensor in SI under the model's excitations, all orders summed with their phases, or one of them.

    The largest over the model's speeds, between those of a range too, or a curve over them. A stress is asked for as
    ``stress(shaft)``.

    Examples
    --------
    >>> import torsionnet as tn
    >>> elements = [tn.Inertia("rotor", node="a", inertia=2), tn.Inertia("wheel", node="b", inertia=1),
    ...     tn.Spring("shaft", nodes=("a", "b"), stiffness="k")]
    >>> fan = tn.Drivetrain("fan", elements, speeds={"of": "a", "list": ["600 rpm"]}, parameters={"k": 1e4},
    ...     excitations={"blades": {"type": "harmonic", "node": "b", "orders": {2: {"amplitude": "10 N*m"}}}})
    >>> block = VariantBlock(fan, {"k": np.array([1e4, 2e4])}, {}, None)
    >>> torques = OrderTorque(output="torque(shaft)").evaluate(block)
    >>> w = 2 * fan.definition.speeds.values[0]
    >>> bool(abs(torques[1, 0] - abs(10 * 4e4 / (6e4 - 2 * w**2))) < 1e-9)
    True
    """

    kind: ClassVar[str] = "order_torque"

    output: str = entry(Text("sensor, torque(element), stress(shaft), ..."))
    order: float | None = entry(Value("one order of its shaft instead of the sum", "1", exclusive=True), None)
    size: str | None = entry(
        OneOf("of the sum: half of its range, largest distance from the mean, root mean square", tuple(SIZES)), None
    )
    curve: bool = entry(Flag("whether every speed is asked for, not the largest over them"), False)

    def contradictions(self) -> list[Fault]:
        if self.order is not None and self.size is not None:
            return [Fault("one order has its amplitude; leave out size", ("size",), on_key=True, kind="needless-entry")]
        return []

    def model_faults(self, model: Drivetrain, quantities: Mapping[str, StudyQuantity]) -> Iterator[Fault]:
        del quantities
        faults = [*usage_faults(lambda: named_output(model, self.output), "output"), *self.empty_range_faults(model)]
        yield from faults or usage_faults(lambda: self._of(self._alone(model)), *(("order",) if self.order else ()))

    @property
    def words(self) -> str:
        what = WORDS[self.size or "half_range"] if self.order is None else f"amplitude of order {self.order:g}"
        return f"{what} of {self.output} {self.range_words}" + (", one by one" if self.curve else ", the largest")

    def measure(self, model: Drivetrain) -> QuantityForm:
        unit = named_output(model, self.output).unit
        return QuantityForm(unit, "speed", self.at(model)) if self.curve else QuantityForm(unit)

    def evaluate(self, block: VariantBlock) -> FloatArray:
        speeds, acting = self.at(block.model), self.excitations or None
        torques = np.full((len(block), len(speeds) if self.curve else 1), np.nan)
        if self.is_range(block.model) and not self.curve:
            for index, largest in largest_orders(block, self.output, speeds, acting, self._sizes):
                torques[index] = largest
            return torques
        for index, run in order_responses(block, self.output, speeds, acting):
            torques[index] = self._of(run)
        return torques

    def _alone(self, model: Drivetrain) -> OrderResponse:
        """Order response of the nominal model at its first speed, for the faults that any speed would have."""
        speeds = self.at(model)
        return model.order_response(
            self.output, speeds=speeds[:1] if len(speeds) else None, excitation=self.excitations or None
        )

    def _of(self, run: OrderResponse) -> FloatArray:
        sizes = self._sizes(run)
        return sizes if self.curve else sizes.max(keepdims=True)

    def _sizes(self, run: OrderResponse) -> FloatArray:
        return SIZES[self.size or "half_range"](run) if self.order is None else self._of_one(run)

    def _of_one(self, run: OrderResponse) -> FloatArray:
        """Largest amplitude of one order at each speed (n_speeds,) in SI, over all phases between excitations."""
        assert self.order is not None
        cases = [case.amplitude_of_order(self.order) for case in run.case_responses]
        lines = [place for place, line in enumerate(run.lines) if not line.fixed and isclose(line.order, self.order)]
        if len(lines) == 1:
            cases.append(run.sizes[:, lines[0], 0])
        return np.asarray(np.max(cases, axis=0))
