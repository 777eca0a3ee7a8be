"""Frequency responses from and into files."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from support.faults import placed_faults

import torsionnet as tn
from torsionnet.app.cli import main
from torsionnet.base.errors import MissingExtraError, ModelError, UsageError
from torsionnet.base.notes import Note, warning
from torsionnet.io import read_frequency_response, read_recording, write_frequency_response, write_recording
from torsionnet.linear.estimation import Estimation
from torsionnet.linear.frequency_response import Channel, FrequencyResponse
from torsionnet.signals.formats import extras
from torsionnet.signals.recording import Recording, Signal

ENDINGS = [".csv", ".npz", ".mat", ".uff", ".unv"]
UNITS = ["rad", "rad/s", "rad/s^2", "N*m"]


def needs(ending):
    if ending in (".uff", ".unv"):
        pytest.importorskip("pyuff")


def response(frequencies, outputs=2, inputs=2, **more):
    random = np.random.default_rng(1)
    shape = (len(frequencies), outputs, inputs)
    values = random.normal(size=shape) + 1j * random.normal(size=shape)
    return FrequencyResponse(
        np.asarray(frequencies, dtype=float),
        values * 10.0 ** random.integers(-9, 9, size=shape),
        tuple(Channel(f"torque(gearbox, y{o})" if o else "y", UNITS[o % 4]) for o in range(outputs)),
        tuple(Channel(f"u_{i}", UNITS[-1 - i % 2]) for i in range(inputs)),
        **more,
    )


def same(found, given):
    np.testing.assert_array_equal(found.frequencies, given.frequencies)
    np.testing.assert_array_equal(found.values, given.values)
    assert (found.outputs, found.inputs, found.title, found.notes) == (
        given.outputs,
        given.inputs,
        given.title,
        given.notes,
    )
    for name in ("coherence", "conditioning"):
        ours, theirs = getattr(found, name), getattr(given, name)
        assert (ours is None) == (theirs is None)
        if ours is not None:
            np.testing.assert_array_equal(ours, theirs)


class TestRoundTrip:
    @pytest.mark.parametrize("ending", ENDINGS)
    def test_keeps_up_to_where_a_test_can_be_used(self, tmp_path, ending):
        needs(ending)
        given = response([1, 2, 3], title="test", usable_up_to=2.5)
        write_frequency_response(given, tmp_path / f"h{ending}")
        found = read_frequency_response(tmp_path / f"h{ending}")
        assert found.usable_up_to == 2.5
        same(found, given)

    @pytest.mark.parametrize("ending", ENDINGS)
    def test_averaging_is_no_note(self, tmp_path, ending):
        needs(ending)
        notes = ("H1, Welch, hann 2 s, overlap 50%, detrend mean, 9 averages worth 5.0",)
        averaging = Estimation("Hv", "hamming", 8.192, 0.75, "linear", 21, 11.8125)
        write_frequency_response(response([1, 2, 3], estimation=averaging, notes=notes), tmp_path / f"h{ending}")
        found = read_frequency_response(tmp_path / f"h{ending}")
        assert found.estimation.to_data() == averaging.to_data()
        assert found.notes == notes

    @pytest.mark.parametrize("ending", [".csv", ".npz", ".mat"])
    def test_notes_keep_severity_and_channel(self, tmp_path, ending):
        notes = (warning("too few"), "warning: rig (left): soft", Note("late", channel="warning"), "mode 3 (x: hot")
        write_frequency_response(response([1.0, 2.0], notes=notes), tmp_path / f"h{ending}")
        assert read_frequency_response(tmp_path / f"h{ending}").notes == notes
        record = Recording((Signal("mode 3 (x", "torque", np.arange(9.0), notes),), 10.0, notes=notes)
        write_recording(record, tmp_path / f"r{ending}")
        again = read_recording(tmp_path / f"r{ending}")
        assert (again.notes, again["mode 3 (x"].notes) == (notes, notes)

    def test_table_as_csv_keeps_averaging(self, tmp_path):
        averaging = Estimation("Hr", "hann", 8.0, 0.75, "mean", 21, 11.81234567, swept=True, references=("T_1",))
        response([1, 2, 3], estimation=averaging, notes=("reworded",)).to_csv(tmp_path / "h.csv")
        found = read_frequency_response(tmp_path / "h.csv")
        assert found.estimation.to_data() == averaging.to_data()
        assert found.notes == ("reworded",)

    def test_warning_has_the_last_line_of_a_universal_file(self, tmp_path):
        needs(".uff")
        averaging = Estimation("H1", "hann", 8.0, 0.75, "mean", 21, 11.8)
        given = response([1, 2, 3], estimation=averaging, notes=("averaged", warning("too few")))
        write_frequency_response(given, tmp_path / "h.uff")
        assert read_frequency_response(tmp_path / "h.uff").notes == ("warning: too few",)

    @pytest.mark.parametrize("ending", [".csv", ".uff"])
    def test_averaging_of_older_files_is_read_from_their_note(self, tmp_path, ending):
        needs(ending)
        path, note = tmp_path / f"h{ending}", "H1, Welch, hann 8 s, overlap 75%, detrend mean, 21 averages worth 11.8"
        given = response([1, 2, 3], title="test", notes=(f"{note} without overlap",))
        given.to_csv(path) if ending == ".csv" else write_frequency_response(given, path)
        averaging = Estimation("H1", "hann", 8.0, 0.75, "mean", 21, 11.8)
        assert read_frequency_response(path).estimation.to_data() == averaging.to_data()

    def test_table_as_csv_keeps_it_too(self, tmp_path):
        response([1, 2, 3], usable_up_to=2.5).to_csv(tmp_path / "h.csv")
        found = read_frequency_response(tmp_path / "h.csv")
        assert found.usable_up_to == 2.5
        assert found.notes == ()

    @pytest.mark.parametrize("frequencies", [[0.1, 0.2, 0.30000000000000004], [1, 2, 3], np.geomspace(0.3, 40, 101)])
    @pytest.mark.parametrize("whole", [True, False])
    @pytest.mark.parametrize("ending", ENDINGS)
    def test_keeps_everything_to_the_last_digit(self, tmp_path, ending, whole, frequencies):
        needs(ending)
        given = response(frequencies, 3, 2, title="run 7 (gear=V)", notes=("bench 2, warm", "a note; with [marks]"))
        if whole:
            random = np.random.default_rng(2)
            extra = {
                "coherence": random.uniform(size=given.values.shape),
                "conditioning": random.uniform(size=len(frequencies)),
            }
            given = replace(given, **extra)
        path = tmp_path / f"r{ending}"
        write_frequency_response(given, path)
        same(read_frequency_response(path), given)

    @pytest.mark.parametrize("ending", [".csv", ".npz", ".mat"])
    def test_one_frequency_one_pair(self, tmp_path, ending):
        given, path = response([3.0], 1, 1), tmp_path / f"r{ending}"
        write_frequency_response(given, path)
        same(read_frequency_response(path), given)

    @pytest.mark.parametrize("ending", [".csv", ".npz", ".mat"])
    def test_what_is_not_finite(self, tmp_path, ending):
        given = response([0.0, 1.0])
        given.values[0, 0, 0], given.values[0, 1, 1] = complex(np.inf, 0), complex(np.nan, np.nan)
        path = tmp_path / f"r{ending}"
        write_frequency_response(given, path)
        same(read_frequency_response(path), given)

    @pytest.mark.parametrize("ending", [".csv", ".npz", ".mat", ".uff"])
    def test_equal_responses_give_equal_bytes(self, tmp_path, ending):
        needs(ending)
        files = [tmp_path / f"{name}{ending}" for name in "ab"]
        for path in files:
            write_frequency_response(response([1.0, 2.5]), path)
        assert files[0].read_bytes() == files[1].read_bytes()

    @pytest.mark.parametrize("ending", [".csv", ".npz", ".mat"])
    @settings(max_examples=25, suppress_health_check=[HealthCheck.function_scoped_fixture, HealthCheck.too_slow])
    @given(
        st.text(max_size=30),
        st.text(st.characters(exclude_categories=["C", "Z"]), min_size=1, max_size=12),
        st.lists(st.text(max_size=20), max_size=3),
    )
    def test_any_names_and_notes(self, tmp_path, ending, title, name, notes):
        given = response([1.0, 2.0], 1, 1, title=title, notes=tuple(notes))
        given = replace(given, outputs=(Channel(name, "rad"),))
        path = tmp_path / f"r{ending}"
        write_frequency_response(given, path)
        same(read_frequency_response(path), given)


class TestTables:
    """CSV of ``FrequencyResponse.to_csv`` and of ``torsionnet frf --csv``: magnitude and phase."""

    @pytest.mark.parametrize("angle", ["rad", "deg"])
    @pytest.mark.parametrize("frequency", ["Hz", "rpm", "rad/s"])
    def test_in_any_units(self, tmp_path, angle, frequency):
        rig = tn.load("dmf_rig")
        given = rig.frequency_response(["theta_1", "velocity(primary)", "T_T"], ["T_M", "primary"], [1.0, 7.0, 90.0])
        given.to_csv(tmp_path / "t.csv", tn.Conventions(angle=angle, frequency=frequency))
        found = read_frequency_response(tmp_path / "t.csv")
        np.testing.assert_allclose(found.values, given.values, rtol=1e-14)
        np.testing.assert_allclose(found.frequencies, given.frequencies, rtol=1e-15)
        assert (found.outputs, found.title) == (given.outputs, given.title)
        assert [channel.unit for channel in found.inputs] == ["N*m", "N*m"]

    def test_of_the_command_line(self, tmp_path, capsys):
        path = tmp_path / "t.csv"
        arguments = ["--output", "theta_1", "--input", "T_T", "--frequencies", "1,2,5", "--angle-unit", "deg"]
        assert main(["frf", "dmf_rig", *arguments, "--csv", str(path)]) == 0
        capsys.readouterr()
        expected = tn.load("dmf_rig").frequency_response("theta_1", "T_T", [1, 2, 5])
        found = read_frequency_response(path)
        np.testing.assert_allclose(found.values, expected.values, rtol=1e-14)
        assert any("excitation" in note for note in found.notes)

    def test_magnitude_and_phase_by_hand(self, tmp_path):
        (tmp_path / "t.csv").write_text("frequency [rpm];|a/M| [deg/(N*m)];phase a/M [deg]\n60;180;-90\n120;0;0\n")
        found = read_frequency_response(tmp_path / "t.csv")
        np.testing.assert_allclose(found.values[:, 0, 0], [-1j * np.pi, 0], atol=1e-15)
        assert found.frequencies.tolist() == [1, 2]
        assert (found.outputs[0], found.inputs[0]) == (Channel("a", "rad"), Channel("M", "N*m"))

    def test_unit_of_a_ratio_is_known_from_another_pair(self, tmp_path):
        heading = "frequency [Hz],re T/M [1],im T/M [1],re a/M [rad/(N*m)],im a/M [rad/(N*m)]"
        (tmp_path / "t.csv").write_text(f"{heading}\n1,2,3,4,5\n")
        found = read_frequency_response(tmp_path / "t.csv")
        assert [channel.unit for channel in (*found.outputs, *found.inputs)] == ["N*m", "rad", "N*m"]
        assert found.notes == ()

    def test_unit_of_a_ratio_alone_is_not_guessed(self, tmp_path):
        (tmp_path / "t.csv").write_text("frequency [Hz],re T/M [1],im T/M [1]\n1,2,3\n")
        found = read_frequency_response(tmp_path / "t.csv")
        assert found.notes == ("T/M: a ratio of like signals; the file does not tell their unit",)

    @pytest.mark.parametrize(
        ("text", "place", "kind"),
        [
            ("", "1:1", "wrong-file"),
            ("frequency [Hz],re a/M [rad/(N*m)],im a/M [rad/(N*m)]\n", "1:1", "wrong-file"),
            ("f [Hz],re a/M [rad],im a/M [rad]\n1,2,3\n", "1:1", "wrong-file"),
            ("frequency [kHz],re a/M [1],im a/M [1]\n1,2,3\n", "1:1", "unknown-unit"),
            (
                "frequency [Hz],re a/M [rad/(N*m)]\n1,2\n",
                "1:16",
                "missing-column",
            ),
            ("frequency [Hz],re a/M [kg],im a/M [kg]\n1,2,3\n", "1:16", "unknown-unit"),
            ("frequency [Hz],|a/M| [dB re 1 rad/(N*m)],phase a/M [deg]\n1,2,3\n", "1:16", "wrong-unit"),
            ("frequency [Hz],|aM| [1],phase aM [deg]\n1,2,3\n", "1:16", "wrong-form"),
            ("frequency [Hz],re a/M [1],im a/M [1]\n1,2,3\n1,x,3\n", "3:3", "not-a-number"),
            ("frequency [Hz];re a/M [1];im a/M [1]\n1,5;2;3\n", "2:1", "not-a-number"),
            ("frequency [Hz],re a/M [1],im a/M [1]\n1,2\n", "2:1", "wrong-count"),
            ("frequency [Hz],re a/M [1],im a/M [1],re b/N [1],im b/N [1]\n1,2,3,4,5\n", "", "missing-data"),
            (
                "configuration,frequency [Hz],re a/M [1],im a/M [1]\nV,1,2,3\nIV,1,2,3\n",
                "1:1",
                "unlike-results",
            ),
        ],
    )
    def test_faults_have_their_place(self, tmp_path, text, place, kind):
        (tmp_path / "t.csv").write_text(text, encoding="utf-8")
        expected = f"t.csv:{place} {kind}" if place else kind
        assert expected in placed_faults(lambda: read_frequency_response(tmp_path / "t.csv"))

    def test_an_early_end_hides_no_other_fault(self, tmp_path):
        heading = "frequency [Hz],re a/M [1],im a/M [1]"
        (tmp_path / "t.csv").write_text(f"# made by hand\n{heading}\n1,2,3\n\n# by the way\n2,x,3\n3,4")
        with pytest.raises(ModelError) as caught:
            read_frequency_response(tmp_path / "t.csv")
        assert [(fault.position.line, fault.position.column) for fault in caught.value.faults] == [(6, 3), (7, 1)]
        assert "im a/M [1]" in caught.value.faults[1].message

    def test_comments_and_blank_lines_between_rows(self, tmp_path):
        (tmp_path / "t.csv").write_text(
            "# rig\nfrequency [Hz],re a/M [1],im a/M [1]\n\n1,2,3\n# usable up to 1.5 Hz\n\n2,4,\n\n"
        )
        found = read_frequency_response(tmp_path / "t.csv")
        np.testing.assert_array_equal(found.values[:, 0, 0], [2 + 3j, complex(4, np.nan)])
        assert (found.title, found.usable_up_to) == ("rig", 1.5)


class TestUniversalFiles:
    """Fixed columns as the SDRC format says, read here by hand, and files that other programs might write."""

    @pytest.fixture
    def pyuff(self):
        return pytest.importorskip("pyuff")

    def test_records(self, tmp_path, pyuff):
        del pyuff
        given = response([1.0, 2.0, 3.0], 1, 1, title="rig", coherence=np.ones((3, 1, 1)))
        path = tmp_path / "r.uff"
        write_frequency_response(given, path)
        raw = path.read_bytes()
        heads = [part.split(b"\n")[1:12] for part in raw.split(b"    -1\n    58b")[1:]]
        assert [int(head[5][:5]) for head in heads] == [4, 6]
        names, record6, record7, abscissa, numerator, denominator = heads[0][0], *heads[0][5:10]
        assert names.strip() == b"y / u_0"
        assert heads[0][1].strip() == b"rig"
        # FORMAT(2(I5,I10),2(1X,10A1,I10,I4)): response entity, node, direction; reference entity, node, direction.
        assert (record6[31:41].strip(), int(record6[41:51]), int(record6[51:55])) == (b"y", 1, 4)
        assert (record6[56:66].strip(), int(record6[66:76]), int(record6[76:80])) == (b"u_0", 2, 4)
        # FORMAT(3I10,3E13.5): complex double precision, three values, evenly spaced from 1 by 1.
        assert [int(record7[at : at + 10]) for at in (0, 10, 20)] == [6, 3, 1]
        assert [float(record7[at : at + 13]) for at in (30, 43)] == [1, 1]
        # FORMAT(I10,3I5,2(1X,20A1)): frequency, rotation (displacement), moment (excitation force).
        for record, code, unit in ((abscissa, 18, b"Hz"), (numerator, 8, b"rad"), (denominator, 13, b"N*m")):
            assert int(record[:10]) == code
            assert record[47:67].strip() == unit

    def test_only_one_channel_over_itself_is_a_driving_point(self, tmp_path, pyuff):
        channels = (Channel("motor", "rad"), Channel("load", "rad")), (Channel("T", "N*m"), Channel("motor", "rad"))
        response = FrequencyResponse(np.array([1.0, 2.0]), np.ones((2, 2, 2), dtype=complex), *channels)
        write_frequency_response(response, tmp_path / "r.uff")
        units, nodes, *functions = pyuff.UFF(str(tmp_path / "r.uff")).read_sets()
        assert (units["type"], units["length"], units["force"]) == (164, 1.0, 1.0)
        assert (nodes["type"], list(nodes["node_nums"])) == (15, [1, 2, 3])
        ends = {item["id1"]: (item["rsp_node"], item["ref_node"]) for item in functions}
        assert {name for name, (above, below) in ends.items() if above == below} == {"motor / motor"}

    def dataset(self, **more):
        base = {
            "type": 58, "binary": 0, "func_type": 4, "id1": "NONE", "id2": "NONE", "id3": "NONE", "id4": "NONE",
            "id5": "NONE", "ver_num": 0, "load_case_id": 0, "rsp_ent_name": "NONE", "ref_ent_name": "NONE",
            "rsp_node": 3, "rsp_dir": 4, "ref_node": 7, "ref_dir": -4, "data": np.array([1 + 2j, 3 - 1j, 2j]),
            "x": np.array([1.0, 2.0, 3.0]), "abscissa_spacing": 1, "abscissa_min": 1.0, "abscissa_inc": 1.0,
            "z_axis_value": 0.0, "abscissa_spec_data_type": 18, "ordinate_spec_data_type": 12,
            "orddenom_spec_data_type": 13, "z_axis_spec_data_type": 0,
        }  # fmt: skip
        return base | more

    def test_names_and_units_from_codes(self, tmp_path, pyuff):
        pyuff.UFF(str(tmp_path / "r.uff")).write_sets(self.dataset(), mode="overwrite")
        found = read_frequency_response(tmp_path / "r.uff")
        assert (found.outputs, found.inputs) == ((Channel("3+RX", "rad/s^2"),), (Channel("7-RX", "N*m"),))
        np.testing.assert_allclose(found.values[:, 0, 0], [1 + 2j, 3 - 1j, 2j])

    def test_labels_are_converted_to_si(self, tmp_path, pyuff):
        labels = {"ordinate_axis_units_lab": "deg", "orddenom_axis_units_lab": "kNm"}
        pyuff.UFF(str(tmp_path / "r.uff")).write_sets(self.dataset(**labels), mode="overwrite")
        found = read_frequency_response(tmp_path / "r.uff")
        assert (found.outputs[0].unit, found.inputs[0].unit) == ("rad", "N*m")
        np.testing.assert_allclose(found.values[0, 0, 0], (1 + 2j) * np.pi / 180 / 1000)

    @pytest.mark.parametrize(
        ("changes", "kind"),
        [
            ({"func_type": 1, "data": np.ones(3)}, "wrong-file"),
            ({"rsp_dir": 1}, "missing-unit"),
            ({"ordinate_axis_units_lab": "m"}, "wrong-unit"),
        ],
    )
    def test_faults(self, tmp_path, pyuff, changes, kind):
        pyuff.UFF(str(tmp_path / "r.uff")).write_sets(self.dataset(**changes), mode="overwrite")
        assert placed_faults(lambda: read_frequency_response(tmp_path / "r.uff")) == [kind]

    def test_faults_of_several_datasets_at_once(self, tmp_path, pyuff):
        other = {"rsp_node": 4, "x": np.array([1.0, 2.0, 4.0]), "abscissa_spacing": 0}
        sets = [self.dataset(), self.dataset(**other), self.dataset()]
        pyuff.UFF(str(tmp_path / "r.uff")).write_sets(sets, mode="overwrite")
        with pytest.raises(ModelError, match=r"(?s)dataset 2 \(4\+RX over 7-RX\).*dataset 3 \(3\+RX") as caught:
            read_frequency_response(tmp_path / "r.uff")
        assert [fault.kind for fault in caught.value.faults] == ["unlike-results", "repeated-name"]

    @pytest.mark.parametrize("name", ["a / b", "n" * 80, "größe"])
    def test_names_without_room_are_refused(self, tmp_path, pyuff, name):
        del pyuff
        given = replace(response([1.0, 2.0], 1, 1), outputs=(Channel(name, "rad"),))
        with pytest.raises(UsageError, match="no-counterpart"):
            write_frequency_response(given, tmp_path / "r.uff")
        assert list(tmp_path.iterdir()) == []

    def test_what_is_not_finite_is_refused(self, tmp_path, pyuff):
        del pyuff  # which would write the largest number for inf, and 0 for nan
        given = response([0.0, 1.0])
        given.values[0, 0, 0] = np.inf
        with pytest.raises(UsageError, match="finite values only"):
            write_frequency_response(given, tmp_path / "r.uff")

    def test_one_frequency_is_refused(self, tmp_path, pyuff):
        del pyuff
        with pytest.raises(UsageError, match="two frequencies or more"):
            write_frequency_response(response([1.0]), tmp_path / "r.uff")

    def test_missing_extra_names_the_command(self, tmp_path, monkeypatch):
        monkeypatch.setitem(extras.EXTRA_PACKAGES, "uff", ("no_such_module", "pyuff", "UFF58"))
        with pytest.raises(MissingExtraError, match=r'pip install "torsionnet\[uff\]"'):
            write_frequency_response(response([1.0, 2.0]), tmp_path / "r.uff")


class TestFaultsOfFiles:
    def test_unknown_ending(self, tmp_path):
        with pytest.raises(UsageError, match=r'(?s)did you mean "\.csv".*wrong-file'):
            read_frequency_response(tmp_path / "r.cvs")

    def test_no_file(self, tmp_path):
        with pytest.raises(UsageError, match="there is no file"):
            read_frequency_response(tmp_path / "r.csv")

    @pytest.mark.parametrize("ending", [".npz", ".mat", ".uff", ".csv"])
    def test_damaged(self, tmp_path, ending):
        needs(ending)
        path = tmp_path / f"r{ending}"
        write_frequency_response(response([1.0, 2.0]), path)
        content = path.read_bytes()
        path.write_bytes(content[: len(content) // 3])
        with pytest.raises(ModelError):
            read_frequency_response(path)

    @pytest.mark.parametrize("ending", [".npz", ".mat"])
    def test_another_kind_of_content(self, tmp_path, ending):
        from scipy.io import savemat

        path = tmp_path / f"r{ending}"
        (savemat if ending == ".mat" else lambda file, data: np.savez(file, **data))(path, {"x": np.arange(3)})
        with pytest.raises(ModelError, match="wrong-file"):
            read_frequency_response(path)

    def test_description_that_does_not_fit_the_numbers(self, tmp_path):
        path = tmp_path / "r.csv"
        write_frequency_response(response([1.0, 2.0]), path)
        path.write_text(path.read_text().replace('["y", "rad"], ', ""))
        with pytest.raises(ModelError, match="unreadable-file"):
            read_frequency_response(path)
