"""Parts that small faults were put into without any other test seeing it: each beside a number of its own."""

import mpmath
import numpy as np
import pytest

import torsionnet as tn
from torsionnet.base.conventions import Conventions
from torsionnet.base.errors import ModelError, UsageError
from torsionnet.identification.fit_file import load_fit_plan
from torsionnet.linear.dynamic_stiffness.many_digits import ManyDigits, _quotient
from torsionnet.linear.dynamic_stiffness.transfer_request import resolve_request
from torsionnet.linear.frequency_response import Channel, FrequencyResponse
from torsionnet.model.files.library import library_benches
from torsionnet.signals import Recording, Signal, Welch, angle_from_pulses, estimate
from torsionnet.signals.bandlimited import NEIGHBOURS, gaps_of
from torsionnet.signals.comparison import agreement
from torsionnet.signals.encoder import angle_from_counts
from torsionnet.signals.excitation import SteppedSine
from torsionnet.signals.resampling import gaps
from torsionnet.signals.welch import without_trend


def rotor(*elements):
    return tn.Drivetrain("rotor", [tn.Inertia("J", node="a", inertia=2), *elements], inputs={"T": {"torque": "a"}})


class TestSymbols:
    def test_hysteretic_damping_turns_the_stiffness_forward(self):
        """1/(k (1 + j eta) - omega^2 J)."""
        rig = rotor(tn.HystereticSpring("k", nodes=("a", "ground"), stiffness=300, loss_factor=0.2))
        found = rig.symbolic().transfer_function("a", "T").evaluate([1.0]).values[0, 0, 0]
        assert found == pytest.approx(1 / (300 * (1 + 0.2j) - (2 * np.pi) ** 2 * 2), rel=1e-12)


class TestWords:
    def test_of_a_mode_without_a_node_of_vibration(self):
        modes = rotor(tn.Spring("k", nodes=("a", "ground"), stiffness=100)).modes()
        assert modes.table().rows[0][-1] == "strain in k 100 %; no node of vibration"


class TestEigenvalues:
    def test_negative_damping_of_a_table_at_the_mode_makes_it_grow(self):
        """The table damps below 2 Hz and drives above; the mode is at 5 Hz."""
        stiffness = 2 * (2 * np.pi * 5) ** 2
        table = [[0.1, stiffness, 1.0], [1.9, stiffness, 1.0], [2.1, stiffness, -1.0], [20, stiffness, -1.0]]
        (mode,) = rotor(tn.TabulatedSpring("k", nodes=("a", "ground"), table=table)).modes().eigenvalues
        assert mode.real == pytest.approx(1 / (2 * 2), rel=1e-3)


class TestManyDigits:
    @pytest.mark.parametrize("ratio", [1, "1/3", "7/3"])
    def test_two_masses_and_a_gear(self, ratio):
        """A torque T on J_1 through a gear to a shaft and J_2, free: theta_1 s^2 (J_1 + J_2 k/(i^2 (k + J_2 s^2))) = T."""
        parts = [
            tn.Inertia("J_1", node="a", inertia="1/7"),
            tn.Gear("gear", nodes=("a", "b"), ratio=ratio),
            tn.Spring("shaft", nodes=("b", "c"), stiffness="1e9/3"),
            tn.Inertia("J_2", node="c", inertia="0.3"),
        ]
        rig = tn.Drivetrain("geared", parts)
        with mpmath.workdps(200):
            J_1, J_2, k, i = (
                mpmath.mpf(x) / y for x, y in ((1, 7), (3, 10), (10**9, 3), map(int, (f"{ratio}/1".split("/")[:2])))
            )
            s = mpmath.mpc(0, mpmath.mpf(1) / 1000)
            expected = 1 / (s**2 * (J_1 + J_2 * k / (i**2 * (k + J_2 * s**2))))
            request = resolve_request(rig, ["a", "torque(shaft)"], ["a"], None)
            (angle,), (torque,) = ManyDigits(rig.assembly, request).transfer(s)
            assert abs(angle / expected - 1) < mpmath.mpf(10) ** -190
            behind = expected / i * k * J_2 * s**2 / (k + J_2 * s**2)
            assert abs(torque / behind - 1) < mpmath.mpf(10) ** -190

    @pytest.mark.parametrize("n", [1, 2, 3, 5])
    def test_quotients_of_readings(self, n):
        rng = np.random.default_rng(n)
        above, below = rng.normal(size=(2, n)), rng.normal(size=(n, n))
        found = _quotient(mpmath.matrix(above).tolist(), mpmath.matrix(below).tolist())
        np.testing.assert_allclose(np.array(found, dtype=float), above @ np.linalg.inv(below), rtol=1e-11)

    def test_zeros_of_an_inverse_are_zero(self):
        """[[a, b], [c, 0]] has the inverse [[0, 1/c], [1/b, -a/(b c)]], however small c is."""
        with mpmath.workdps(100):
            a, b, c = mpmath.mpf(1) / 3, mpmath.mpf(10) ** -30 / 7, mpmath.mpf(10) ** -60 / 11
            found = _quotient([[1, 0]], [[a, b], [c, 0]])
        assert found[0][0] == 0
        assert float(found[0][1] * c) == pytest.approx(1)

    def test_readings_that_depend_on_each_other(self):
        with mpmath.workdps(100):
            third = mpmath.mpf(1) / 3
            assert _quotient([[1, 0]], [[third, 1], [third * third, third]]) is None


class TestSignals:
    def test_a_counter_of_few_bits_begins_anew(self):
        assert angle_from_counts([200, 250, 44], 2 * np.pi, bits=8).tolist() == pytest.approx([200, 250, 300])

    def test_pulses_do_not_depend_on_when_the_clock_began(self):
        times = np.sort(np.concatenate([np.arange(0, 3, 0.01), [0.503, 1.207]]))  # two double pulses
        with pytest.warns(tn.TorsionnetWarning):
            early, begin = angle_from_pulses(times, 20, 500)
        with pytest.warns(tn.TorsionnetWarning):
            late, _ = angle_from_pulses(times + 4096, 20, 500)
        assert begin == 0.0
        np.testing.assert_allclose(late, early, atol=1e-6)
        assert early[-1] == pytest.approx(2 * np.pi / 20 * 100 * 2.99, rel=1e-3)

    def test_the_trend_of_each_row_is_its_own(self):
        x = np.array([[1.0, 2.0, 3.0], [5.0, 5.0, 8.0]])
        np.testing.assert_allclose(without_trend(x, "mean"), [[-1, 0, 1], [-1, -1, 2]], atol=1e-15)
        np.testing.assert_allclose(without_trend(x, "linear"), [[0, 0, 0], [0.5, -1, 0.5]], atol=1e-15)

    def test_one_stamp_has_no_gap(self):
        assert gaps(np.array([1.0])).size == 0

    def test_a_window_that_nobody_knows(self):
        with pytest.raises(UsageError, match='did you mean "hann"'):
            Welch("hanm", 1.0).weights(100.0)

    def test_a_stepped_sine_of_zero_frequency(self):
        with pytest.raises(UsageError, match="positive"):
            SteppedSine(frequencies=(5.0, 0.0), hold=1.0)

    def test_a_peak_of_ten_lines_is_not_narrow(self):
        """Half power over 1.27 Hz, lines 1/8 Hz apart."""
        rng, rate, n = np.random.default_rng(0), 200.0, 40_000
        torque = rng.normal(size=n)
        s = 2j * np.pi * np.fft.rfftfreq(n, 1 / rate)
        angle = np.fft.irfft(np.fft.rfft(torque) / (s**2 + 8 * s + (2 * np.pi * 20) ** 2), n)
        record = Recording((Signal("T", "torque", torque), Signal("phi", "angle", angle)), rate)
        notes = " ".join(map(str, estimate(record, "phi", "T", settings=Welch("hann", 8.0)).notes))
        assert "half-power bandwidth" not in notes

    def test_a_rate_that_an_hdf5_file_states(self, tmp_path):
        h5py = pytest.importorskip("h5py")
        with h5py.File(tmp_path / "r.h5", "w") as file:
            file["T_T"] = np.arange(4.0)
            file["T_T"].attrs["unit"] = "N*m"
            file.attrs["fs"] = 250.0
        assert tn.signals.read_recording(tmp_path / "r.h5").sampling_rate == 250


class TestResponses:
    def test_the_largest_response_is_told_in_the_unit_asked_for(self):
        channels = (Channel("phi", "rad"),), (Channel("T", "N*m"),)
        test = FrequencyResponse(np.array([1.0, 2.0]), np.array([1 + 0j, 3.0])[:, None, None], *channels, "test")
        rows = agreement(test, test, Conventions(angle="deg")).rows
        assert rows[0][1:] == (2.0, pytest.approx(np.degrees(3.0)), "deg/(N*m)")


class TestFiles:
    def test_a_fit_file_that_is_no_yaml(self, tmp_path):
        file = tmp_path / "fit.yaml"
        file.write_text("torsionnet: 1\nmodel: {rig\n")
        with pytest.raises(ModelError, match=r"fit.yaml") as caught:
            load_fit_plan(file, tn.io.read_frequency_response)
        assert caught.value.faults[0].position.line == 2


def test_times_of_pulses_become_an_angle(tmp_path):
    """Ten teeth at 2 turns a second."""
    file = tmp_path / "pulses.csv"
    file.write_text("pulse [s]\n" + "\n".join(f"{0.05 * i:.4f}" for i in range(80)) + "\n")
    record = tn.signals.read_recording(file, pulses={"pulse": 10}, sampling_rate=100)
    assert np.ptp(record["pulse"].values) / np.ptp(record.time) == pytest.approx(4 * np.pi, rel=1e-3)


class TestInANotebook:
    def test_a_drivetrain_shows_its_tables(self):
        shown = tn.load("amt_rig").configured("V")._repr_html_()
        assert ">inertia I_MT = 0.078 kg*m^2</td>" in shown
        assert "<caption>Parameters" in shown

    def test_a_large_one_shows_the_first_rows(self):
        elements = [tn.Spring(f"k{i}", nodes=(f"n{i}", f"n{i + 1}"), stiffness=1) for i in range(199)]
        elements.append(tn.Inertia("J", node="n0", inertia=1))
        shown = tn.Drivetrain("large", elements, description="<b>")._repr_html_()
        assert "the first 60 of 200" in shown
        assert shown.count("<tr>") == 61

    def test_a_recording_shows_its_signals(self):
        record = Recording((Signal("T", "torque", np.array([1.0, np.nan, 3.0])),), 10.0)
        assert record.table().rows == (("T", "torque", "N*m", 2.0, 1.0, 1.0, 3.0),)
        assert "3 samples at 10 Hz" in record._repr_html_()

    def test_large_symbolic_systems_are_one_line(self):
        assert len(repr(tn.load("six_cylinder_diesel").symbolic())) < 150


class TestBenchFiles:
    """Each is a fault with its place, never an error of Python."""

    @pytest.mark.parametrize(
        ("good", "bad", "where", "message"),
        [
            ("{type: encoder, lines: 1024}", "{type: {}}", "theta_1: {type: ", "no sensor type is named"),
            ("{type: linear chirp,", "{type: [a],", "excitation: {type: ", "no excitation type is named"),
            ("rate: 10 kHz", "rate: 1e9 Hz", "acquisition: {rate: ", "1e+11 samples; at most 1e+08"),
            (
                "rate: 10 kHz",
                "rate: 1e308 Hz",
                "acquisition: {rate: ",
                "far outside the sizes of drivetrains and their tests",
            ),
        ],
    )
    def test_refused(self, tmp_path, good, bad, where, message):
        text = library_benches()["dmf_bench"].read_text(encoding="utf-8").replace(good, bad)
        (tmp_path / "bench.yaml").write_text(text, encoding="utf-8")
        with pytest.raises(ModelError) as caught:
            tn.load_bench(tmp_path / "bench.yaml")
        (fault,) = caught.value.faults
        assert message in fault.message
        assert where.split(":")[0].strip() in text.splitlines()[fault.position.line - 1]

    @pytest.mark.parametrize("seconds", [1e-150, 0, 1e9, 1e308, float("nan")])
    def test_length_of_a_segment(self, seconds):
        with pytest.raises(UsageError, match=r"out-of-range"):
            Welch("hann", seconds)


@pytest.mark.parametrize(("before", "behind"), [(0, 0), (-1, 0), (0, -1)])
def test_a_gap_is_filled_that_has_pulses_enough_on_either_side(before, behind):
    """Two pulses missing between as many pulses as the sum over its neighbours needs, or one fewer."""
    first = NEIGHBOURS + before
    numbers = np.delete(np.arange(first + 2 + NEIGHBOURS + behind), [first, first + 1])
    assert [gap.first.tolist() for gap in gaps_of(numbers)] == [[] if before or behind else [first]]
