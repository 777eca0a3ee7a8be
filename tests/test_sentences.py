"""What the test of first sentences in test_layers.py takes for a fragment."""

from __future__ import annotations

import pytest
from structure.sentences import first_sentence, is_fragment


@pytest.mark.parametrize(
    "sentence",
    [
        "Of all laws at omega in rad/s",
        "With names that no element has",
        "The same, but for another order of elimination",
        "W",
        "As it was given",
        "What runs in the drivetrain",
        "All that occur, in Hz",
        "Where its teeth mesh",
    ],
)
def test_fragments_are_found(sentence):
    assert is_fragment(sentence)


@pytest.mark.parametrize(
    "sentence",
    [
        "Torque of each law in N m, shape (n_f,)",
        "All inputs by name",
        "Whether the drivetrain turns freely",
        "Solve the equations of motion",
        "Lowest modes of a large system",
    ],
)
def test_sentences_pass(sentence):
    assert not is_fragment(sentence)


def test_first_sentence_ends_at_the_first_stop():
    assert first_sentence("Torque in N m on a\n    free node. More.\n\nRest.") == "Torque in N m on a free node"
    assert first_sentence("Order of an engine: half orders too.") == "Order of an engine"
