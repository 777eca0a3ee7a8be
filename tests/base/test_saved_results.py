"""Results as JSON with all their numbers, tables as data frames and as text for a terminal."""

import json
import re
from collections.abc import Mapping
from dataclasses import fields, is_dataclass, replace
from pathlib import Path

import numpy as np
import pytest
from support import every_result

import torsionnet as tn
from torsionnet.base.notes import Note
from torsionnet.base.table import Column, Table

F = np.array([0.0, 2.0, 9.0])


def same(first, second):
    """Whether two values are equal, with arrays compared number by number, and results field by field."""
    if isinstance(first, np.ndarray):
        np.testing.assert_array_equal(first, second)
        return isinstance(second, np.ndarray)
    if is_dataclass(first):
        kept = [one.name for one in fields(first) if one.init and "unsaved" not in one.metadata]
        return type(first) is type(second) and all(same(getattr(first, one), getattr(second, one)) for one in kept)
    if isinstance(first, Mapping):
        return list(first) == list(second) and all(same(one, second[key]) for key, one in first.items())
    if isinstance(first, tuple | list):
        return len(first) == len(second) and all(map(same, first, second))
    return first == second or (first != first and second != second)


def read_again(result, tmp_path):
    """The result out of its JSON text, and the same out of a file."""
    path = tmp_path / "saved.json"
    text = result.to_json(path)
    assert path.read_text(encoding="utf-8") == text
    for found in (type(result).from_json(text), type(result).from_json(path), type(result).from_json(str(path))):
        assert type(found) is type(result)
        yield found


@pytest.mark.parametrize("name", ["dmf_rig", "two_stroke_ship"])
def test_modes_are_read_back(name, tmp_path):
    modes = tn.load(name).modes()
    for found in read_again(modes, tmp_path):
        assert all(same(getattr(modes, one.name), getattr(found, one.name)) for one in fields(modes))


def test_responses_are_read_back(tmp_path):
    H = tn.load("dmf_rig").frequency_response(["theta_1", "T_T"], "T_T", F)
    for found in read_again(replace(H, usable_up_to=12.5, coherence=np.full(H.values.shape, 0.5)), tmp_path):
        assert (found.outputs, found.inputs, found.title) == (H.outputs, H.inputs, H.title)
        assert (found.notes, found.usable_up_to, found.model) == (H.notes, 12.5, H.model)
        np.testing.assert_array_equal(found.values, H.values)
        np.testing.assert_array_equal(found.conditioning, H.conditioning)


def test_numbers_that_json_lacks(tmp_path):
    theta, torque = tn.Channel("phi", "rad"), tn.Channel("T", "N*m")
    note = Note("at rest", "warning", channel="phi")
    H = tn.FrequencyResponse(F, [np.inf, np.nan, 1 - 2j], (theta,), (torque,), notes=("warning: a plain text", note))
    for found in read_again(H, tmp_path):
        np.testing.assert_array_equal(found.values, H.values)
        assert found.notes == H.notes
    json.loads(H.to_json(), parse_constant=lambda name: pytest.fail(f"{name} is no JSON"))


def test_an_estimate_keeps_its_averaging_but_not_its_record(tmp_path):
    rng = np.random.default_rng(2)
    signals = {"T": rng.normal(size=2000), "phi": rng.normal(size=2000)}
    record = tn.signals.Recording(
        [tn.signals.Signal("T", "torque", signals["T"]), tn.signals.Signal("phi", "angle", signals["phi"])], 500
    )
    H = tn.signals.estimate(record, "phi", "T")
    for found in read_again(H, tmp_path):
        assert found.estimation.to_data() == H.estimation.to_data()
        assert found.estimation.record is None


OF_FOLDERS = {"Recording", "Study", "StudyResult", "Campaign", "CampaignResult", "Bench"}
"""Results and questions that files or folders of their own keep."""


def saved_classes():
    """Names of all classes of the package whose results JSON files keep, from the bases written in its modules."""
    sources = [path.read_text(encoding="utf-8") for path in Path(tn.__file__).parent.rglob("*.py")]
    written = [found for text in sources for found in re.findall(r"^class (\w+)\(([\w, ]+)[,)]", text, re.MULTILINE)]
    assert {name for name, bases in written if "NotebookResult" in bases.split(", ")} == {"SavedResult", *OF_FOLDERS}
    known, before = {"SavedResult"}, set()
    while known != before:
        before = set(known)
        known |= {name for name, bases in written if known & set(bases.split(", "))}
    return known - {"SavedResult", "DrawnConclusion", "PlainConclusion"}


@pytest.mark.slow  # a sample of each class is calculated
def test_every_result_is_read_back_and_has_tables_for_pandas_and_notebooks():
    """A class with ``to_json`` of which there is no sample fails, too."""
    seen = set()
    for result in every_result.results():
        kind = type(result)
        seen.add(kind.__name__)
        assert same(result, kind.from_json(result.to_json())), kind.__name__
        assert len(result.to_dataframe()), kind.__name__
        assert "<table" in result._repr_html_(), kind.__name__
        assert repr(result).startswith("<"), kind.__name__
    assert saved_classes() - seen == set()


def test_wrong_files_are_told(tmp_path):
    rig = tn.load("dmf_rig")
    with pytest.raises(tn.UsageError, match="wrong-file"):
        tn.FrequencyResponse.from_json(rig.modes().to_json())
    with pytest.raises(tn.UsageError, match="wrong-file"):
        tn.Modes.from_json("{}")
    with pytest.raises(tn.UsageError, match="wrong-file"):
        tn.Modes.from_json("{modes")
    with pytest.raises(tn.UsageError, match="missing-file"):
        tn.Modes.from_json(tmp_path / "none.json")
    data = json.loads(rig.modes().to_json())
    with pytest.raises(tn.UsageError, match="wrong-file"):
        tn.Modes.from_json(json.dumps({key: one for key, one in data.items() if key != "eigenvalues"}))


TABLE = Table("t", (Column("name"), Column("x", "Hz", 3)), (("a", 1.25), ("b", None)), ("n",))


def test_a_table_is_read_back(tmp_path):
    path = tmp_path / "table.json"
    text = TABLE.to_json(path)
    assert Table.from_json(text).rows == Table.from_json(path).rows == TABLE.rows
    assert Table.from_json(text).columns == (Column("name"), Column("x", "Hz"))
    with pytest.raises(tn.UsageError, match="holds no table"):
        Table.from_json('{"title": "t"}')


def test_data_frames():
    frame = TABLE.to_dataframe()
    assert frame["name"].tolist() == ["a", "b"]
    assert frame.attrs["units"] == {"name": "", "x": "Hz"}
    np.testing.assert_array_equal(frame["x"], [1.25, np.nan])
    rig = tn.load("dmf_rig")
    H = rig.frequency_response(["theta_1", "T_T"], "T_M", F)
    complex_values = H.to_dataframe()
    np.testing.assert_array_equal(complex_values["T_T/T_M"], H.values[:, 1, 0])
    assert complex_values.index.name == "frequency [Hz]"
    assert complex_values.attrs["units"]["theta_1/T_M"] == "rad/(N*m)"
    modes = rig.modes()
    np.testing.assert_array_equal(modes.to_dataframe()["damping ratio"], modes.damping_ratios)
    assert modes.energy_table().to_dataframe().shape == (len(modes.elements), 7)


def test_tables_fit_the_terminal(monkeypatch):
    monkeypatch.setenv("COLUMNS", "60")
    text = str(tn.load("amt_rig").configured("II").modes().table())
    assert max(map(len, text.splitlines())) <= 60
    assert text.count("mode") >= 2  # the first column stands in every part
    assert "strain in half_shaft 82 %, dmf 18 %" in " ".join(text.split())
    assert "<caption>" in TABLE._repr_html_()
