"""Help of the command line: groups by what a user does, examples that use options there are, words from elsewhere."""

import re
import shlex

import pytest
from support.command_line import run

from torsionnet.app.cli.app import COMMANDS, GROUPS, SAME, app


def options_of(name):
    return {word for one in app.get_command(None, name).params for word in (*one.opts, *one.secondary_opts)}


def examples_of(name):
    """Lines below the heading "Examples" of a command's help, each with what continues it."""
    _, _, lines = run(name, "--help").stdout.partition("\nExamples:\n")
    return [line.strip() for line in lines.replace("\\\n", " ").splitlines() if line.strip()]


def test_help_lists_the_commands_below_their_groups():
    text = run("--help").stdout
    headings = re.findall(r"^(\S[^:\n]*):$", text, re.MULTILINE)
    assert headings == ["Options", *GROUPS]
    for group, commands in GROUPS.items():
        below = text.partition(f"\n{group}:\n")[2].partition("\n\n")[0]
        assert re.findall(r"^  ([\w-]+) ", below, re.MULTILINE) == list(commands)


@pytest.mark.parametrize("name", COMMANDS)
def test_examples_stand_at_the_end_and_use_options_that_the_command_has(name):
    examples = examples_of(name)
    assert examples
    for line in examples:
        words = shlex.split(line.rpartition("| ")[2])
        assert words[0] == "torsionnet"
        assert {word for word in words[2:] if re.match("--?[a-z]", word)} <= options_of(words[1])


def test_report_names_word():
    assert "Word" in COMMANDS["report"]


@pytest.mark.parametrize(
    ("word", "same"),
    [
        ("bode", "torsionnet frf --plot"),
        ("plot", "frf --plot"),
        ("eig", "torsionnet modes"),
        ("step", "torsionnet simulate"),
        ("Campbell", "torsionnet critical-speeds --plot"),
        ("order", '"orders"'),
        ("simulat", '"simulate"'),
    ],
)
def test_a_word_from_elsewhere_names_what_does_the_same(word, same):
    said = run(word, "amt_rig", code=2).stderr
    assert f'no command is named "{word}"' in said
    assert same in said


def test_words_from_elsewhere_are_no_commands_and_lead_to_commands():
    words = [word for words in SAME.values() for word in words.split()]
    assert sorted(words) == sorted(set(words))
    assert not set(words) & set(COMMANDS)
    for said in SAME:
        name, *rest = said.partition(",")[0].split()
        if name in COMMANDS:
            assert {word for word in rest if word.startswith("--")} <= options_of(name)
        else:
            assert name in {"--help", "--version"}


@pytest.mark.parametrize(
    ("words", "kind"),
    [
        ("bogus", "unknown-word"),
        ("--bogus", "unknown-word"),
        ("modes amt_rig --bogus", "unknown-word"),
        ("modes", "missing-entry"),
        ("modes amt_rig --digits", "missing-entry"),
        ("modes amt_rig more", "needless-entry"),
        ("modes amt_rig --digits three", "not-a-number"),
        ("modes amt_rig --digits 40", "out-of-range"),
        ("frf amt_rig --frequency-unit m", "unknown-word"),
        ("modes amt_rig --csv no/where.csv", "missing-file"),
        ("modes amt_rig --set k_1", "wrong-form"),
        ("modes amt_rig --set k_1=4...2", "not-a-number"),
        ("modes amt_rig --json --digits 3", "contradicting-entries"),
    ],
)
def test_wrong_words_of_a_command_have_a_kind(words, kind):
    assert run(*shlex.split(words), code=2).stderr.rstrip().endswith(f"[{kind}]")
