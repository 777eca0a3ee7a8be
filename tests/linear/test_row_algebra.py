"""Rows up to a factor: what cancels, what is the same, and what a row is the sum of, in exact numbers."""

import operator
from fractions import Fraction
from itertools import combinations, product

import pytest

from torsionnet.linear.dynamic_stiffness.row_algebra import (
    Rounded,
    combine_rows,
    common_motion,
    equivalent_links,
    normalised,
)

NOTHING, LITTLE = 1e-14, 1e-12
"""Relative differences below and above what rounding leaves."""


@pytest.mark.parametrize("sign", [1, -1])
class TestCombined:
    def test_what_cancels_but_for_rounding_is_gone(self, sign):
        first, second = {0: 3.0, 1: sign * 0.3, 2: 5.0}, {0: 1.0, 1: sign * 0.1}
        assert 3.0 * 0.1 != 0.3
        assert combine_rows(first, second, 0) == {2: 5.0}

    @pytest.mark.parametrize(("off", "left"), [(NOTHING, set()), (LITTLE, {1})])
    def test_how_much_is_rounding(self, sign, off, left):
        first, second = {0: 2.0, 1: sign * 6.0}, {0: 1.0, 1: sign * 3.0 * (1 + off)}
        assert set(combine_rows(first, second, 0)) == left

    def test_small_beside_others_is_kept(self, sign):
        first, second = {0: 1.0, 1: 1e20}, {0: 1.0, 2: sign * 1e-20}
        assert combine_rows(first, second, 0) == {1: 1e20, 2: -sign * 1e-20}

    def test_opposite_terms_add(self, sign):
        assert combine_rows({0: 3.0, 1: sign * 0.25}, {0: 1.0, 1: -sign * 0.5}, 0) == {1: sign * 1.75}

    def test_each_coordinate_in_one_row_only(self, sign):
        first, second = {0: sign * 2.0, 1: 5.0}, {0: 7.0, 2: 11.0}
        assert combine_rows(first, second, 0) == {1: 35.0, 2: -sign * 22.0}

    def test_second_row_without_the_coordinate(self, sign):
        assert combine_rows({0: sign * 2.0, 1: 5.0}, {2: 3.0}, 0) == {2: -sign * 6.0}


class TestNormalised:
    def test_first_coefficient_is_one(self):
        key, unit, factor = normalised({3: 2.0, 1: -4.0})
        assert (key, unit, factor) == (((1, 1.0), (3, -0.5)), {1: 1.0, 3: -0.5}, -4.0)
        assert list(unit) == [1, 3]

    def test_one_coordinate(self):
        assert normalised({2: -4.0}) == (((2, 1.0),), {2: 1.0}, -4.0)

    def test_same_key_to_thirteen_digits(self):
        (one, _, _), (same, unit, _), (other, _, _) = (
            normalised({0: 1.0, 1: value}) for value in (0.12345678901234, 0.12345678901231, 0.1234567890129)
        )
        assert one == same != other
        assert unit[1] == 0.12345678901231

    def test_whole_numbers_are_not_rounded(self):
        whole = 2.0**53 - 1
        assert normalised({0: 1.0, 1: whole})[0] == ((0, 1.0), (1, whole))


def outer(row):
    """The entries of row row^T, exactly."""
    return {(i, j): Fraction(a) * Fraction(b) for i, a in row.items() for j, b in row.items()}


def total(parts):
    found = {}
    for row, weight in parts:
        for place, value in outer(row).items():
            found[place] = found.get(place, 0) + Fraction(weight) * value
    return {place: value for place, value in found.items() if value}


class TestClique:
    @pytest.mark.parametrize(
        "row", [{0: 1.0, 1: -2.0, 2: 4.0}, {5: -3.0, 2: 0.5, 7: 2.0, 1: 8.0}, {0: 2.0, 1: 0.5}, {4: -2.0}]
    )
    @pytest.mark.parametrize("scale", [(1.0, 1.0, 1.0, 1.0), (2.0, -0.5, 4.0, 0.25)])
    def test_acts_as_the_row(self, row, scale):
        d = dict(zip(sorted(row), scale, strict=False))
        parts = list(equivalent_links(row, d))
        assert total(parts) == outer(row)
        links = [tuple(part) for part, _ in parts if len(part) == 2]
        assert sorted(links) == list(combinations(sorted(row), 2))
        assert {tuple(part) for part, _ in parts if len(part) == 1} == {(i,) for i in row}
        assert all(sum(part[i] * d[i] for i in part) == 0 for part, _ in parts if len(part) == 2)

    @pytest.mark.parametrize("sign", [1, -1])
    def test_no_grounds_where_the_row_does_not_answer(self, sign):
        row = {0: sign * 0.1, 1: sign * 0.2, 2: -sign * 0.3}
        assert sum(row.values()) != 0
        assert [tuple(part) for part, _ in equivalent_links(row, dict.fromkeys(row, 1.0))] == [(0, 1), (0, 2), (1, 2)]

    @pytest.mark.parametrize("sign", [1, -1])
    @pytest.mark.parametrize(("off", "grounds"), [(NOTHING, 0), (LITTLE, 2)])
    def test_how_much_is_rounding(self, sign, off, grounds):
        row = {0: 10.0, 1: -5.0 * (1 + sign * off)}
        assert sum(len(part) == 1 for part, _ in equivalent_links(row, {0: 0.5, 1: 1.0})) == grounds


class TestCommonMotion:
    def test_links_along_a_tree_do_not_resist(self):
        rows = [{0: 1.0, 1: -2.0}, {1: 4.0, 2: 5.0}, {3: 3.0, 1: -1.5}, {7: 1.0, 8: -8.0}]
        assert common_motion(rows) == {0: 1.0, 1: 0.5, 2: -0.4, 3: 0.25, 7: 1.0, 8: 0.125}

    def test_only_links_of_two(self):
        assert common_motion([{0: 1.0}, {0: 1.0, 1: 1.0, 2: 1.0}, {4: 1.0, 5: -1.0}]) == {4: 1.0, 5: 1.0}

    @pytest.mark.parametrize("order", [1, -1])
    def test_links_that_turn_the_same_way_come_first(self, order):
        rows = [{0: 1.0, 1: 1.0}, {0: 1.0, 1: -1.0}]
        assert common_motion(rows[::order]) == {0: 1.0, 1: 1.0}

    def test_also_the_long_way_round(self):
        rows = [{0: 1.0, 1: 3.0}, {0: 1.0, 2: -2.0}, {2: 1.0, 1: -2.0}]
        assert common_motion(rows) == {0: 1.0, 2: 0.5, 1: 0.25}


@pytest.mark.parametrize("calculated", [operator.add, operator.mul, operator.truediv])
@pytest.mark.parametrize(("first", "second"), [*product((3.0, -3.0), (0.5, -0.5))])
def test_the_bound_of_an_error_is_what_both_can_do_together(calculated, first, second):
    """The farthest of the four corners of two intervals, to the first order of their widths."""
    errors = 3e-9, 2e-9
    found = calculated(Rounded(first, errors[0]), Rounded(second, errors[1]))
    exact = calculated(first, second)
    corners = [calculated(first + i * errors[0], second + j * errors[1]) for i, j in product((-1, 1), repeat=2)]
    assert found.value == exact
    assert found.error == pytest.approx(max(abs(one - exact) for one in corners), rel=1e-6)
    assert [calculated(first, Rounded(second, 0.0)).error, calculated(Rounded(first, 0.0), second).error] == [0, 0]
