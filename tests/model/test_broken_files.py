"""Model files with mistakes: what is said about each, and the place (line:column) that is shown first."""

import pytest
from support.broken_models import BASE, CASES
from support.faults import is_as_expected

from torsionnet.base.errors import ModelError, UsageError
from torsionnet.drivetrain import load, loads
from torsionnet.model.files.located_yaml import PythonParser, compose
from torsionnet.model.files.reader import read_file, read_text


def test_base_is_sound():
    assert [fault.severity for fault in read_text(BASE, "base.yaml")[1]] == ["note"]


def test_names_of_cases_are_unique():
    assert len({case.name for case in CASES}) == len(CASES) >= 60


@pytest.mark.parametrize("case", CASES, ids=lambda case: case.name)
def test_says_what_is_wrong_and_where(case):
    definition, faults = read_text(case.text, "model.yaml")
    errors = [fault for fault in faults if fault.severity == "error"]
    assert definition is None
    assert is_as_expected(errors[0], case.fault)
    assert f"{errors[0].position.line}:{errors[0].position.column}" == case.place


ALONE = [case for case in CASES if case.name not in {"two faults at once", "shaft mm as bare kg", "planetary"}]


@pytest.mark.parametrize("case", ALONE, ids=lambda case: case.name)
def test_one_mistake_is_one_error(case):
    _, faults = read_text(case.text, "model.yaml")
    assert [fault.severity for fault in faults].count("error") == 1


@pytest.mark.parametrize("case", CASES, ids=lambda case: case.name)
def test_every_fault_has_a_place_and_one_line(case):
    _, faults = read_text(case.text, "model.yaml")
    lines = case.text.split("\n")
    places = [(fault.position.line, fault.position.column) for fault in faults]
    assert places == sorted(places)
    for fault in faults:
        assert 1 <= fault.position.line <= len(lines)
        assert 1 <= fault.position.column <= len(lines[fault.position.line - 1]) + 1
        assert fault.position.end_column > fault.position.column
        assert fault.message.isprintable()
        assert fault.kind or fault.severity == "note"


@pytest.mark.parametrize("case", CASES, ids=lambda case: case.name)
def test_refused_with_all_errors(case):
    with pytest.raises(ModelError, match=r"errors? in model\.yaml\.") as caught:
        loads(case.text, "model.yaml")
    assert all(fault.severity == "error" for fault in caught.value.faults)


@pytest.mark.parametrize("case", CASES, ids=lambda case: case.name)
def test_python_parser_agrees(case):
    """Where PyYAML has no C library: the same data, or a refusal as well."""

    def outcome(parser):
        try:
            return compose(case.text, "model.yaml", parser).data
        except ModelError as error:
            return len(error.faults)

    assert outcome(PythonParser) == outcome(None)


BREAKS = [  # the kind of a break and a text that has it: PyYAML says both only in words, which versions may change
    ("open-bracket", "a: {b: 1\nc: 2\n"),
    ("open-bracket", "a: [b, 1\nc: 2\n"),
    ("open-quote", "a: 'b\nc: 2\n"),
    ("open-quote", 'a: "b\nc: 2\n'),
    ("missing-value", "a: [,]\n"),
    ("missing-value", "a: }\n"),
    ("wrong-indentation", "a:\n  b: 1\n c: 2\n"),
    ("wrong-indentation", "a: {b: 1}}\n"),
    ("wrong-indentation", "  a: 1\nb: 2\n"),
    ("wrong-indentation", "a:\n\tb: 1\n"),
    ("missing-colon", "a: 1\nb\nc: 2\n"),
    ("missing-colon", "a:\n  b {c: 1, e: 2}\n"),
    ("stray-colon", "a: b: c\n"),
    ("missing-quotes", "a: @b\n"),
    ("missing-quotes", "a: %b\n"),
    ("missing-quotes", "a: !x!y 1\n"),
    ("unknown-escape", 'a: "\\q"\n'),
    ("invalid-character", "a: \x01\n"),
    ("missing-quotes", "a: !b 1\n"),
    ("missing-quotes", "a: *b\n"),
]


@pytest.mark.parametrize("parser", [PythonParser, None])
@pytest.mark.parametrize(("kind", "text"), BREAKS)
def test_the_kind_of_a_break_is_known_with_every_version_of_pyyaml(kind, text, parser):
    with pytest.raises(ModelError) as caught:
        compose(text, "model.yaml", parser)
    assert caught.value.faults[-1].kind == kind


def test_two_faults_both_shown():
    with pytest.raises(ModelError) as caught:
        loads(BASE.replace("kg*m^2", "kg*m").replace("torque: shaft", "torque: shft"), "broken.yaml")
    text = str(caught.value)
    assert "broken.yaml:6:50: error: " in text
    assert "broken.yaml:10:46: error: " in text
    assert "\n2 errors in broken.yaml. " in text
    assert "      |                                                  ^^^^^^^^\n" in text


BYTES = {
    "utf-16": (BASE.encode("utf-16"), "UTF-16", (1, 1)),
    "utf-16 without mark": (BASE.encode("utf-16-le"), "UTF-16", (1, 1)),
    "latin-1": (BASE.replace("chain", "Prüfstand").encode("latin-1"), "0xfc is no UTF-8", (2, 9)),
    "nul": (BASE.replace("chain", "ch\0ain").encode(), "U+0000", (2, 9)),
    "escape": (BASE.replace("chain", "ch\x1bain").encode(), "U+001B", (2, 9)),
    "cut within a letter": ("a: ü".encode()[:-1], "0xc3 is no UTF-8", (1, 4)),
    "too large": (b"#" * 4_000_001, "too large", (1, 1)),
    "empty": (b"", "the file is empty", (1, 1)),
    "only a byte order mark": (b"\xef\xbb\xbf", "the file is empty", (1, 1)),
    "too many entries": (b"a: [" + b"1," * 200_001 + b"]", "more than 200000 entries", (1, 400_005)),
}


@pytest.mark.few(2)
@pytest.mark.parametrize(("content", "message", "place"), BYTES.values(), ids=BYTES)
def test_bytes_that_are_no_model(tmp_path, content, message, place):
    path = tmp_path / "model.yaml"
    path.write_bytes(content)
    definition, (fault,) = read_file(path)
    assert definition is None
    assert message in fault.message
    assert (fault.position.line, fault.position.column) == place
    with pytest.raises(ModelError, match=r"1 error in model\.yaml"):
        load(path)


@pytest.mark.parametrize("newline", ["\n", "\r\n", "\r"])
@pytest.mark.parametrize("mark", ["", "\ufeff"])
def test_line_ends_and_byte_order_marks_do_not_matter(tmp_path, newline, mark):
    path = tmp_path / "model.yaml"
    path.write_bytes((mark + BASE).replace("\n", newline).encode())
    assert load(path) == loads(BASE)
    path.write_bytes((mark + BASE.replace("angle: motor", "angle: motr")).replace("\n", newline).encode())
    _, faults = read_file(path)
    error = next(fault for fault in faults if fault.severity == "error")
    assert (error.position.line, error.position.column, error.position.end_column) == (10, 26, 30)
    assert error.position.source == "sensors: {theta: {angle: motr}, T: {torque: shaft}}"


def test_missing_files_name_what_there_is(tmp_path):
    (tmp_path / "gearbox.yaml").write_text(BASE)
    (tmp_path / "notes.txt").write_text(BASE)
    (tmp_path / "sheet.csv").write_text(BASE)
    expected = {
        tmp_path / "gerbox.yaml": '"gearbox.yaml".*missing-file',
        tmp_path: "gearbox.yaml.*wrong-file",
        tmp_path / "sheet.csv": "torsionnet import.*wrong-file",
        tmp_path / "notes.txt": "[.]yaml, [.]yml, [.]json.*wrong-file",
        tmp_path / "gone" / "x.yaml": "missing-file",
        "amt_rigg": '"amt_rigg".*"amt_rig".*missing-file',
        "zzzz": "amt_rig, b.*missing-file",
        "a\0b": r"U\+0000.*invalid-name",
        "x" * 5000 + ".yaml": "missing-file",
        "": "wrong-file",
    }
    for model, message in expected.items():
        with pytest.raises(UsageError, match=f"(?s){message}"):
            load(model)


def test_file_that_may_not_be_read(tmp_path, monkeypatch):
    path = tmp_path / "model.yaml"
    path.write_text(BASE)

    def refuse(_):
        raise PermissionError(13, "Permission denied")

    monkeypatch.setattr(type(path), "read_bytes", refuse)
    with pytest.raises(UsageError, match="unreadable-file"):
        load(path)


def test_a_long_line_is_not_printed_and_a_long_message_is_cut():
    definition, faults = read_text(BASE + "operating_point: [" + "abc, " * 1000 + "]\n", "model.yaml")
    error = next(fault for fault in faults if fault.severity == "error")
    assert definition is None
    assert error.position.source == ""
    assert len(error.message) < 700


def test_a_wrong_speed_hides_no_wrong_torque():
    _, faults = read_text(BASE + "operating_point:\n  speed: {a: nonsense +}\n  torque: {nowhere: 50}\n", "model.yaml")
    errors = [(fault.kind, fault.position.line) for fault in faults if fault.severity == "error"]
    begin = BASE.count("\n") + 2
    assert errors == [("unreadable-expression", begin), ("unknown-node", begin + 1)]


def test_a_key_with_escapes_cannot_reach_the_terminal():
    _, faults = read_text(BASE + '"\\e[31mred": 1\n', "model.yaml")
    assert all("\x1b" not in str(fault) for fault in faults)
    assert any("\\x1b[31mred" in fault.message for fault in faults)
