"""Results declared once: JSON, its schema and tables from the fields of a class."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Annotated, ClassVar, Literal, get_args

import numpy as np
import pytest
from numpy.typing import NDArray

from torsionnet.app.cli.output import OUTPUTS, output_kinds
from torsionnet.base.conventions import Conventions
from torsionnet.base.result_fields import json_schema, out_fields, to_json
from torsionnet.base.result_rows import NUMBER_ROWS, Out
from torsionnet.base.table import Column, result_table


@dataclass(frozen=True)
class Part:
    """Part of a row."""

    share: float


@dataclass(frozen=True, eq=False)
class Row:
    """Row with a field of every kind."""

    name: Annotated[str, Out("name")]
    frequency: Annotated[float, Out("frequency", "Hz", "frequency_Hz", digits=4)]
    speed: Annotated[float | None, Out("speed", "rpm", factor=10.0)]
    pole: complex
    shape: Mapping[str, complex]
    curve: NDArray[np.float64]
    matrix: Annotated[NDArray[np.float64], Out(schema=NUMBER_ROWS)]
    parts: tuple[Part, ...]
    verdict: Literal["pass", "fail"]
    hidden: Annotated[int, Out(json=None)] = 3
    more: Annotated[int | None, Out(optional=True)] = None

    @property
    def twice(self) -> Annotated[float, Out("twice", json="twice_Hz", after="frequency")]:
        """Twice the frequency."""
        return 2 * self.frequency

    @property
    def plain(self) -> int:
        """A property that is not declared."""
        return 1


def row(**changes):
    values = {
        "name": "a", "frequency": 1.5, "speed": None, "pole": -1 + 2j, "shape": {"n": np.complex128(1j)},
        "curve": np.array([1.0, np.nan]), "matrix": np.eye(2), "parts": (Part(0.5),), "verdict": "pass",
    }  # fmt: skip
    return Row(**values | changes)


@dataclass(frozen=True)
class Peak:
    """Result that holds more than it shows, with a value calculated once."""

    points: tuple[float, ...]
    place: Annotated[int, Out("place")]
    SHOWN: ClassVar = ("largest", "place", "half")

    @cached_property
    def largest(self) -> Annotated[float, Out("amplitude", "rad", "largest_rad")]:
        """Largest of the points."""
        return max(self.points)

    @property
    def half(self) -> float:
        """Half of it, declared by its type alone."""
        return self.largest / 2


def test_a_result_that_names_what_it_shows_has_no_other_keys():
    peak = Peak((1.0, 3.0), 1)
    assert to_json(peak) == {"largest_rad": 3.0, "place": 1, "half": 1.5}
    assert list(json_schema(Peak)["properties"]) == ["largest_rad", "place", "half"]
    table = result_table("peaks", [peak], Peak)
    assert [column.heading for column in table.columns] == ["amplitude [rad]", "place"]
    assert table.rows == ((3.0, 1),)


@dataclass(frozen=True)
class Place:
    """Result that shows fields of its parts."""

    peak: Peak
    other: Peak | None = None
    SHOWN: ClassVar = ("peak.largest", "peak.half", "other.place")


def test_a_result_shows_fields_of_its_parts():
    peak = Peak((1.0, 3.0), 1)
    assert to_json(Place(peak)) == {"largest_rad": 3.0, "half": 1.5, "place": None}
    assert to_json(Place(peak, peak))["place"] == 1
    assert json_schema(Place)["properties"]["half"] == json_schema(float)
    assert result_table("places", [Place(peak, peak)], Place).rows == ((3.0, 1),)


@dataclass(frozen=True)
class Reading:
    """Value in a unit of its own."""

    value: Annotated[float | None, Out("value", unit_of="unit")]
    unit: Annotated[str, Out("unit", unit_of="unit")]


def test_rows_of_different_units_are_shown_each_in_its_own():
    rows = [Reading(np.pi, "rad"), Reading(2e6, "Pa"), Reading(None, "N*m/rad")]
    table = result_table("readings", rows, Reading, conventions=Conventions(angle="deg"))
    assert table.rows == ((pytest.approx(180.0), "deg"), (2.0, "N/mm^2"), (None, "N*m/deg"))


def test_json_has_the_declared_keys_in_their_order():
    data = to_json(row())
    assert list(data) == [
        "name",
        "frequency_Hz",
        "twice_Hz",
        "speed",
        "pole",
        "shape",
        "curve",
        "matrix",
        "parts",
        "verdict",
    ]
    assert data["pole"] == [-1.0, 2.0]
    assert data["shape"] == {"n": [0.0, 1.0]}
    assert data["matrix"] == [[1.0, 0.0], [0.0, 1.0]]
    assert data["parts"] == [{"share": 0.5}]
    assert data["twice_Hz"] == 3.0
    assert to_json(row(more=4))["more"] == 4


@pytest.mark.parametrize(
    ("change", "fault"),
    [
        ({}, ""),
        ({"more": 2}, ""),
        ({"name": None}, "name"),
        ({"verdict": "maybe"}, "verdict"),
        ({"curve": ["x"]}, "curve"),
        ({"more": -1}, "more"),
        ({"twice_Hz": "x"}, "twice_Hz"),
        ({"another": 1}, "another"),
    ],
)
def test_schema_takes_what_is_written_and_nothing_else(change, fault):
    import jsonschema

    data = to_json(row(curve=np.ones(2))) | change
    found = list(jsonschema.Draft202012Validator(json_schema(Row)).iter_errors(data))
    assert bool(found) == bool(fault)
    assert not fault or fault in str(found[0])


def test_every_key_but_optional_ones_is_required():
    import jsonschema

    data = to_json(row(curve=np.ones(2)))
    for key in data:
        rest = {name: value for name, value in data.items() if name != key}
        assert list(jsonschema.Draft202012Validator(json_schema(Row)).iter_errors(rest)), key


def test_table_has_the_fields_with_headings_in_the_units_shown():
    table = result_table("t", [row(), row(speed=2.0)], Row, conventions=Conventions(frequency="rpm"))
    assert table.columns == (Column("name"), Column("frequency", "rpm", 4), Column("twice"), Column("speed", "rpm"))
    assert table.rows == (("a", 90.0, 3.0, None), ("a", 90.0, 3.0, 20.0))
    some = result_table("t", [row()], Row, ["speed", "name"])
    assert [column.name for column in some.columns] == ["speed", "name"]


def test_types_without_a_schema_are_refused():
    with pytest.raises(TypeError, match=r"Out\(schema"):
        json_schema(object)


def declared(kind):
    """Fields of a record and of the records in it."""
    for one in out_fields(kind):
        yield one
        for part in (one.type, *get_args(one.type)):
            if dataclasses.is_dataclass(part):
                yield from declared(part)


@pytest.mark.parametrize("command", sorted(OUTPUTS))
def test_a_column_in_hertz_has_a_key_in_hertz(command):
    """One declaration says both; they must not contradict each other."""
    fields = [one for kind in output_kinds(command) if isinstance(kind, type) for one in declared(kind)]
    wrong = [one.name for one in fields if one.key and one.out.unit == "Hz" and not one.key.endswith("_Hz")]
    assert wrong == []
