"""Results made of plain numbers by hand: what their properties, selections and tables make of them."""

import json
from dataclasses import replace

import numpy as np
import pytest

import torsionnet as tn
from torsionnet.base.conventions import Conventions
from torsionnet.base.errors import UsageError
from torsionnet.base.table import Column, Table
from torsionnet.linear.frequency_response import Channel, FrequencyResponse
from torsionnet.linear.modes.modes import Modes
from torsionnet.linear.phase import unwrapped_phase
from torsionnet.linear.responses.shared_response import FrequencyResponses

TURN = 2 * np.pi
OUTPUTS = (Channel("phi", "rad"), Channel("omega", "rad/s"))
INPUTS = (Channel("T", "N*m"),)


class TestModes:
    """A rigid body, a real pole of -6 pi, and one of 5 Hz: 3-4-5, so that zeta is 0.6 and 4 Hz are heard."""

    MODES = Modes(
        eigenvalues=TURN * np.array([0, -3, -3 + 4j]),
        kinds=("rigid body", "real pole", "oscillatory"),
        nodes=("a", "b"),
        shapes=np.array([[1, 1, 0.5j], [1, -0.25, -1]], dtype=complex),
        undamped_natural_frequencies=np.array([0, 3.5, 7]),
        elements=("disc", "shaft"),
        kinetic=np.array([[1.0, 0.75, 0.5], [0.0, 0.25, 0.5]]),
        strain=np.array([[0.0, 0.0, 0.125], [0.0, 1.0, 0.875]]),
        dissipated=np.array([[0.0, 0.375, 0.0625], [0.0, 0.625, 0.9375]]),
        converged=np.array([True, True, False]),
        descriptions=("turns", "creeps", "swings"),
        title="two discs",
        notes=("a note",),
    )

    def test_frequencies_and_damping(self):
        np.testing.assert_allclose(self.MODES.natural_frequencies, [0, 3, 5])
        np.testing.assert_allclose(self.MODES.damped_frequencies, [0, 0, 4])
        np.testing.assert_allclose(self.MODES.damping_ratios, [np.nan, 1, 0.6])

    @pytest.mark.parametrize(("unit", "scale"), [("Hz", 1), ("rpm", 60), ("rad/s", TURN)])
    def test_table(self, unit, scale):
        table = self.MODES.table(Conventions(frequency=unit))
        assert [column.unit for column in table.columns] == ["", unit, unit, "1", "rad/s", "rad/s", "", ""]
        assert table.rows[2][0] == 1
        assert table.rows[2][1:6] == pytest.approx((5 * scale, 4 * scale, 0.6, -3 * TURN, 4 * TURN))
        assert table.rows[2][6:] == ("oscillatory", "swings")
        assert [row[0] for row in table.rows] == [None, None, 1]
        numbers = ", ".join(f"{value * scale:.6g}" for value in (0, 3.5, 7))
        assert table.notes[1:] == (f"undamped natural frequencies [{unit}]: {numbers}", "a note")
        assert "mode 1 is the lowest vibration" in table.notes[0]

    def test_shapes(self):
        table = self.MODES.shape_table()
        assert [column.heading for column in table.columns[:3]] == [
            "node",
            "|shape rigid body| [rad]",
            "phase rigid body [deg]",
        ]
        assert table.columns[-1].name == "phase 1"
        assert table.rows == (("a", 1, 0, 1, 0, 0.5, 90), ("b", 1, 0, 0.25, 180, 1, 180))
        np.testing.assert_array_equal(self.MODES.shape_at("b"), [1, -0.25, -1])
        with pytest.raises(UsageError, match=r'(?s)did you mean "b".*unknown-node'):
            self.MODES.shape_at("B")

    def test_energies(self):
        table = self.MODES.energy_table()
        heads = [
            f"{what} {mode}" for mode in ("rigid body", "real pole", 1) for what in ("kinetic", "strain", "dissipated")
        ]
        assert [column.name for column in table.columns] == ["element", *heads]
        assert table.rows[0] == ("disc", 100, 0, 0, 75, 0, 37.5, 50, 12.5, 6.25)
        assert table.rows[1] == ("shaft", 0, 0, 0, 25, 100, 62.5, 50, 87.5, 93.75)
        assert self.MODES.energy_shares(1) == {"disc": (0.75, 0, 0.375), "shaft": (0.25, 1, 0.625)}

    def test_first(self):
        first = self.MODES.first(2)
        assert len(first) == 2
        assert first.shapes.shape == first.kinetic.shape == first.strain.shape == first.dissipated.shape == (2, 2)
        assert (first.kinds, first.descriptions) == (("rigid body", "real pole"), ("turns", "creeps"))
        assert first.undamped_natural_frequencies.tolist() == [0, 3.5]
        assert first.converged.tolist() == [True, True]
        assert len(self.MODES.first(None)) == 3


def response(**more):
    values = np.array([[[3 + 4j], [1j]], [[-2], [-1]], [[1], [2 - 2j]]], dtype=complex)
    return FrequencyResponse(np.array([1.0, 2.0, 4.0]), values, OUTPUTS, INPUTS, "two", **more)


class TestFrequencyResponse:
    def test_one_pair_of_own_arrays_needs_no_axes_of_length_one(self):
        own = FrequencyResponse([1, 2], [1j, 2], OUTPUTS[:1], list(INPUTS), coherence=np.array([0.5, 1.0]))
        assert own.values.tolist() == [[[1j]], [[2]]]
        assert own.coherence.tolist() == [[[0.5]], [[1.0]]]
        assert (own.frequencies.dtype, own.inputs) == (float, INPUTS)

    @pytest.mark.parametrize(
        ("frequencies", "values", "words"),
        [
            ([1.0, 2.0], [1j, 2, 3], "wrong-count"),
            ([1.0, 2.0], [[1j, 2]], "wrong-count"),
            ([[1.0], [2.0]], [1j, 2], "wrong-count"),
        ],
    )
    def test_arrays_that_do_not_fit_are_refused(self, frequencies, values, words):
        with pytest.raises(UsageError, match=words):
            FrequencyResponse(frequencies, values, OUTPUTS[:1], INPUTS)

    def test_table_with_coherence(self):
        coherence = np.array([0.5, 0.75, 1.0])[:, None, None] * np.array([[1.0], [0.5]])
        shown = Conventions(angle="deg", frequency="rpm")
        table = response(coherence=coherence, notes=("first",), usable_up_to=3.0).table(shown)
        assert [column.heading for column in table.columns] == [
            "frequency [rpm]",
            "|phi/T| [deg/(N*m)]",
            "phase phi/T [deg]",
            "coherence phi/T [1]",
            "|omega/T| [deg/s/(N*m)]",
            "phase omega/T [deg]",
            "coherence omega/T [1]",
        ]
        degrees = 180 / np.pi
        first = (60, 5 * degrees, np.degrees(np.arctan2(4, 3)), 0.5, degrees, 90, 0.25)
        assert table.rows[0] == pytest.approx(first)
        assert table.rows[1] == pytest.approx((120, 2 * degrees, 180, 0.75, degrees, 180, 0.375))
        assert table.notes[:2] == ("first", "usable_up_to: 3 Hz")
        assert "usable" not in " ".join(response().table().notes)

    def test_between_keeps_what_belongs_to_the_lines(self):
        whole = response(conditioning=np.array([0.1, 0.2, 0.3]), coherence=np.full((3, 2, 1), 0.9))
        part = whole.between(2.0, 4.0)
        assert part.frequencies.tolist() == [2, 4]
        assert part.conditioning.tolist() == [0.2, 0.3]
        assert part.values.shape == part.coherence.shape == (2, 2, 1)
        assert (response().between(1, 2).conditioning, response().between(1, 2).coherence) == (None, None)

    def test_select_keeps_what_belongs_to_the_pairs(self):
        part = response(coherence=np.arange(6.0).reshape(3, 2, 1)).select("omega")
        assert part.coherence[:, 0, 0].tolist() == [1, 3, 5]
        assert (part.outputs, part.inputs) == (OUTPUTS[1:], INPUTS)
        with pytest.raises(UsageError, match=r'(?s)did you mean "T".*unknown-channel'):
            response().select(input="t")

    def test_orders_of_unlike_outputs(self):
        s = TURN * 1j * np.array([1.0, 2.0, 4.0])
        receptance = response().receptance()
        np.testing.assert_allclose(receptance.values[:, 0, 0], response().values[:, 0, 0])
        np.testing.assert_allclose(receptance.values[:, 1, 0], response().values[:, 1, 0] / s)
        assert {channel.unit for channel in receptance.outputs} == {"rad"}
        with pytest.raises(UsageError, match="unfit-channel"):
            replace(response(), outputs=(OUTPUTS[0], INPUTS[0])).mobility()

    @pytest.mark.parametrize(
        ("above", "below", "kind", "unit"),
        [
            ("rad", "N*m", "receptance", "rad/(N*m)"),
            ("rad/s^2", "N*m", "accelerance", "rad/s^2/(N*m)"),
            ("N*m", "N*m", "torque ratio", "1"),
            ("N*m", "rad", "dynamic stiffness", "N*m/rad"),
            ("N*m", "rad/s", "transfer function", "N*m/(rad/s)"),
            ("rad", "rad", "motion ratio", "1"),
            ("rad", "rad/s", "transfer function", "rad/(rad/s)"),
        ],
    )
    def test_words_and_units(self, above, below, kind, unit):
        one = FrequencyResponse(np.ones(1), np.ones((1, 1, 1)), (Channel("y", above),), (Channel("u", below),))
        assert (one.kind(), one.unit()) == (kind, unit)
        power = ("rad" in above) - ("rad" in below)
        assert one.scale(Conventions(angle="deg")) == pytest.approx((180 / np.pi) ** power)
        assert one.decibels(Conventions(angle="deg", db_reference=10.0))[0, 0, 0] == pytest.approx(
            20 * (power * np.log10(180 / np.pi) - 1)
        )

    def test_amplitudes_of_several_inputs_add_with_their_phases(self):
        values = np.array([[[1, 1j]], [[2, -2]]], dtype=complex)
        both = FrequencyResponse(np.array([1.0, 2.0]), values, OUTPUTS[:1], (Channel("T", "N*m"), Channel("U", "N*m")))
        np.testing.assert_allclose(both.response_amplitude([3.0, 4.0]), [[5], [2]])
        per_line = np.array([[3.0, 4.0], [1.0, 0.0]])
        shown = both.response_amplitude(per_line, Conventions(angle="deg", amplitude="peak-to-peak"))
        np.testing.assert_allclose(shown, np.array([[5], [2]]) * 360 / np.pi)

    def test_no_inverse_of_what_is_not_finite(self):
        square = response().select("phi")
        broken = replace(square, values=np.where(square.frequencies[:, None, None] == 2, np.inf, square.values))
        with pytest.raises(UsageError, match="not-finite"):
            broken.dynamic_stiffness()


class TestFamily:
    VALUES = np.stack([response().values, 2j * response().values])

    def family(self, **more):
        parameters = {"k": np.array([100.0, 250.0]), "c": np.array([0.5, 1.5])}
        return FrequencyResponses(parameters, response().frequencies, self.VALUES, OUTPUTS, INPUTS, "rig", **more)

    def test_each_is_a_response(self):
        family = self.family(conditioning=np.arange(6.0).reshape(2, 3), notes=("n",))
        assert len(family) == 2
        first, second = family
        assert (first.title, second.title) == ("rig, k = 100, c = 0.5", "rig, k = 250, c = 1.5")
        np.testing.assert_array_equal(second.values, self.VALUES[1])
        assert (second.conditioning.tolist(), second.notes) == ([3, 4, 5], ("n",))
        assert self.family()[0].conditioning is None

    def test_magnitude(self):
        np.testing.assert_allclose(self.family().magnitude[1], 2 * response().magnitude)
        assert not np.iscomplexobj(self.family().magnitude)


class TestTable:
    TABLE = Table("t", (Column("name"), Column("x", "Hz", 3)), (("a", 1.23456), ("b", np.nan), ("long", None)), ("n",))

    def test_text(self):
        lines = ["t", "name  x [Hz]", "----  ------", "a       1.23", "b          -", "long       -", "n"]
        assert self.TABLE.to_text() == str(self.TABLE) == "\n".join(lines)

    def test_csv_and_json(self):
        assert self.TABLE.to_csv() == "# t\n# n\nname,x [Hz]\na,1.23456\nb,\nlong,\n"
        assert json.loads(self.TABLE.to_json()) == {
            "title": "t",
            "columns": [{"name": "name", "unit": ""}, {"name": "x", "unit": "Hz"}],
            "rows": [["a", 1.23456], ["b", None], ["long", None]],
            "notes": ["n"],
        }
        assert json.loads(replace(self.TABLE, rows=(("a", np.inf),)).to_json())["rows"] == [["a", None]]

    def test_html_has_texts_at_the_left_and_is_escaped(self):
        text = replace(self.TABLE, title="<b>", rows=(("a & b", 2.0),)).to_html()
        assert "<caption>&lt;b&gt;<br><small>n</small></caption>" in text
        assert '<tr><td style="text-align:left">a &amp; b</td><td>2</td></tr>' in text


class TestPhase:
    def test_goes_on_beyond_half_a_turn(self):
        angles = np.radians([170, 179, 181, 200, -10 - 360])
        np.testing.assert_allclose(unwrapped_phase(np.exp(1j * angles)), [170, 179, 181, 200, 350])

    def test_half_a_turn_lags(self):
        assert unwrapped_phase(np.array([-1 + 0j, -1 - 1e-12j])).tolist() == pytest.approx([-180, -180])
        assert unwrapped_phase(np.array([np.exp(1j * np.radians(179.999))]))[0] == pytest.approx(179.999)

    def test_nothing_has_no_phase(self):
        found = unwrapped_phase(np.array([0, 1j, np.inf, -1]))
        np.testing.assert_allclose(found, [np.nan, 90, np.nan, 180])
        assert np.isnan(unwrapped_phase(np.zeros(2, dtype=complex))).all()


def test_conventions():
    assert Conventions().frequency_scale == Conventions().amplitude_scale == 1
    assert Conventions(frequency="rad/s").frequency_scale == TURN
    assert tn.Conventions(frequency="cpm").frequency_scale == 60
    assert Conventions(angle="deg").unit("rad/s") == "deg/s"
    assert Conventions(angle="deg").scale("N*m") == 1
    for reference in (np.inf, np.nan, 0.0, -1.0):
        with pytest.raises(UsageError, match="out-of-range"):
            Conventions(db_reference=reference)
