"""Phrases: texts that keep their template and values, and are plain texts in all else."""

import copy
import json
import pickle

import pytest

from torsionnet.base.phrases import ModelName, Phrase, extended, joined, phrase, with_values

SENTENCE = phrase("{limit} not judged{where}", limit="tail", where=phrase(" in {count} of {all}", count=2, all=3))


def test_it_is_a_text():
    assert SENTENCE == "tail not judged in 2 of 3"
    assert {SENTENCE: 1}["tail not judged in 2 of 3"] == 1
    assert json.dumps(SENTENCE) == '"tail not judged in 2 of 3"'


@pytest.mark.parametrize("again", [copy.copy, copy.deepcopy, lambda text: pickle.loads(pickle.dumps(text)), str])
def test_copies_are_phrases(again):
    same = again(SENTENCE)
    assert same == SENTENCE
    assert (same.template, same.values["where"].values) == (SENTENCE.template, {"count": "2", "all": "3"})


def test_a_place_without_a_value_is_refused():
    with pytest.raises(KeyError, match="where"):
        phrase("{limit} not judged{where}", limit="tail")


def test_values_change_at_every_depth():
    assert with_values(SENTENCE, str.upper) == "TAIL not judged in 2 of 3"
    named = phrase("a {b}", b=phrase("c {d}", d="e"))
    assert with_values(named, str.upper) == "a c E"


def test_names_in_a_phrase_are_those_of_a_part_where_a_message_says_so():
    where = joined(", ", (phrase("in {element}", element=ModelName("left.hub")), "left.rim"))
    text = phrase("{}; grows", phrase("strain {where}", where=where))
    assert text.in_names(lambda name: name.removeprefix("left.")) == "strain in hub, left.rim; grows"


def test_texts_without_places_are_joined_and_extended():
    assert joined("; ", []) == ""
    assert not isinstance(extended("tail", "; wet"), Phrase)
    assert joined("; ", ("a", SENTENCE)).values["text1"].template == SENTENCE.template
