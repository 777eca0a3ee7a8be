"""One word for one thing: the table of arguments and options, and what it refuses."""

import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]


@pytest.fixture(scope="module")
def words_page():
    sys.path.insert(0, str(ROOT / "docs"))
    try:
        import words_page

        yield words_page
    finally:
        sys.path.remove(str(ROOT / "docs"))


def test_arguments_and_options_are_in_the_table_with_one_meaning(words_page):
    assert [": ".join(one) for one in words_page.faults()] == []


def test_table_has_arguments_and_options_of_one_word_in_one_line(words_page):
    (line,) = [line for line in words_page.words_page().splitlines() if line.startswith("| `measured_input` ")]
    for place in ("Drivetrain.modes()", "torsionnet modes", "sensor that is the input"):
        assert place in line or "functions" in line


@pytest.mark.parametrize(
    ("use", "said"),
    [
        (("wobble", "Drivetrain.modes()", {"number"}), ("no word of docs/words.yaml", "wobble: {means: ...")),
        (("band", "torsionnet frf", {"SPEED"}), ("`band` takes SPEED here", "else rename")),
    ],
)
def test_a_new_word_and_a_second_meaning_are_refused_with_what_to_do(words_page, monkeypatch, use, said):
    monkeypatch.setattr(words_page, "uses", lambda: iter([use]))
    ((place, *text),) = words_page.faults()
    assert place == use[1]
    for part in said:
        assert part in "; ".join(text)


def test_two_lines_and_two_words_of_one_meaning_are_refused(words_page, monkeypatch, tmp_path):
    source = tmp_path / "words.yaml"
    source.write_text(
        "speed: {means: a speed, takes: []}\nrpm: {means: a speed, takes: []}\nrpm: {means: r, takes: []}\n"
    )
    monkeypatch.setattr(words_page, "SOURCE", source)
    monkeypatch.setattr(words_page, "uses", lambda: iter([]))
    words_page.words.cache_clear()
    try:
        assert [text for _, text, _ in words_page.faults()] == ["`rpm` has two lines"]
        source.write_text("speed: {means: a speed, takes: []}\nrpm: {means: a speed, takes: []}\n")
        words_page.words.cache_clear()
        assert len(list(words_page.faults())) == 2
    finally:
        monkeypatch.undo()
        words_page.words.cache_clear()


def test_kinds_of_options_are_those_of_the_commands(words_page):
    found = {(word, place): kinds for word, place, kinds in words_page.uses()}
    assert found["driven_by", "torsionnet frf"] == {"INPUT"}
    assert found["driven_by", "Drivetrain.frequency_response()"] == {"text"}
    assert found["full", "torsionnet frf"] == {"flag"}
