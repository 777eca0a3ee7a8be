from fractions import Fraction

from torsionnet.model.elimination import reduce_rows, smallest_failing_rows, substitute

ORDER = {name: index for index, name in enumerate("abcdef")}


def test_each_row_eliminates_its_last_name():
    found = reduce_rows([{"a": 1, "b": -1}, {"b": 1, "c": Fraction(-2)}], ORDER)
    assert found.solved == {"b": {"a": 1}, "c": {"a": Fraction(1, 2)}}


def test_later_rows_reach_back_into_earlier_solutions():
    found = reduce_rows([{"a": 1, "d": -1}, {"a": Fraction(1), "b": Fraction(-3)}, {"b": Fraction(1)}], ORDER)
    assert found.solved == {"d": {}, "b": {}, "a": {}}
    assert found.origin("d") == {0, 1, 2}


def test_dependent_rows_are_told_apart_from_blocked_ones():
    rows = [{"a": 1, "b": -1}, {"b": 2, "a": -2}, {"a": 1}]
    found = reduce_rows(rows, ORDER, keep={"a"})
    assert (found.redundant, found.origin_of_row(1)) == ((1,), {0})
    assert (found.blocked, found.origin_of_row(2)) == ((2,), set())
    assert found.rank == 1


def test_names_to_keep_are_kept_if_possible():
    assert reduce_rows([{"a": Fraction(1), "b": Fraction(-2)}], ORDER, keep={"b"}).solved == {"a": {"b": 2}}


def test_decisions_are_exact():
    """In floats 3 * 0.1 is not 0.3 and the loop would not close."""
    rows = [
        {"a": Fraction(1), "b": Fraction(-1, 10)},
        {"b": Fraction(1), "c": Fraction(-3)},
        {"a": Fraction(1), "c": Fraction(-3, 10)},
    ]
    found = reduce_rows(rows, ORDER)
    assert (found.redundant, found.origin_of_row(2)) == ((2,), {0, 1})


def test_substitute_drops_what_cancels():
    assert substitute({"a": 1, "b": -1}, {"b": {"a": 1}}) == {}


def test_smallest_culprits_leaves_out_bystanders():
    rows = [{"a": 1}, {"b": 1}, {"a": 1, "c": 1}, {"c": 1}]
    assert smallest_failing_rows(rows, range(4), lambda some: {"a": 1} in some and {"c": 1} in some) == [0, 3]
