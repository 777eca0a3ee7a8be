"""Determinants and adjugates by blocks, in exact rationals against sympy's matrices."""

import random
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from support import campaigns, strategies

import torsionnet as tn
from torsionnet.base.program import Program
from torsionnet.symbolic.algebra import deletion_contraction
from torsionnet.symbolic.algebra.deletion_contraction import SplitBlock
from torsionnet.symbolic.algebra.network import Network, NetworkMember, Stiffness
from torsionnet.symbolic.algebra.recursion import is_forest, orient, roots_of
from torsionnet.symbolic.algebra.scaled import NumericValues
from torsionnet.symbolic.mechanism import bilinear, determinant, recursion_from, single_edges

EXAMPLES = settings(max_examples=campaigns.examples(5, 30), deadline=None)
COEFFICIENTS = [-3, -2, -1, 1, 1, 2, Fraction(1, 3)]


class Draw:
    """A network of laws k_0, k_1, ... with a number for each."""

    def __init__(self, source, count):
        self.random, self.names = source, [f"q{i}" for i in range(count)]
        self.members, self.values = [], {}

    def law(self, *names, coefficients=()):
        import sympy

        k = sympy.Symbol(f"k_{len(self.members)}")
        self.values[k] = Fraction(self.random.randint(1, 20), self.random.randint(1, 5))
        chosen = coefficients or self.random.choices(COEFFICIENTS, k=len(names))
        row = {name: sympy.sympify(value) for name, value in zip(names, chosen, strict=True)}
        self.members.append(NetworkMember(row, Stiffness(k)))

    def grounds(self, share):
        for name in self.names:
            if self.random.random() < share:
                self.law(name)

    def tree(self, connected=1.0):
        """Up to three laws from each coordinate to an earlier one."""
        for i, name in enumerate(self.names[1:], 1):
            above = self.names[self.random.randrange(i)]
            for _ in range(self.random.randint(1, 3) if self.random.random() < connected else 0):
                self.law(above, name)

    def ties(self, count, width):
        for _ in range(count):
            self.law(*self.random.sample(self.names, min(width, len(self.names))))

    @property
    def network(self):
        return Network(tuple(self.names), tuple(self.members))

    @property
    def matrix(self):
        import sympy

        index = {name: number for number, name in enumerate(self.names)}
        total = sympy.zeros(len(index))
        for member in self.members:
            row = sympy.zeros(1, len(index))
            for name, value in member.row.items():
                row[index[name]] = value
            total += row.T * row * self.number(member.law.stiffness)
        return total

    def number(self, k):
        import sympy

        return sympy.Rational(self.values[k].numerator, self.values[k].denominator)

    def row(self, count):
        import sympy

        return {
            name: sympy.Integer(self.random.choice([-2, -1, 1, 3])) for name in self.random.sample(self.names, count)
        }

    def vector(self, row):
        import sympy

        return sympy.Matrix([row.get(name, 0) for name in self.names])

    def run(self, node):
        return node.program.values_in(NumericValues(self.values, lambda value: value, Fraction(0)), [node])[0]


def assert_exact(drawn):
    matrix, network, program = drawn.matrix, drawn.network, Program()
    assert drawn.run(determinant(network, program)) == matrix.det()
    adjugate = matrix.adjugate()
    for count in {1, min(2, len(drawn.names)), len(drawn.names)}:
        reading, load = drawn.row(count), drawn.row(1)
        expected = (drawn.vector(reading).T * adjugate * drawn.vector(load))[0]
        assert drawn.run(bilinear(network, program, reading, load)) == expected
    member = drawn.random.choice(drawn.members)
    expected = (drawn.vector(member.row).T * adjugate * drawn.vector(load))[0]
    assert drawn.run(bilinear(network, program, member.row, load)) == expected


class TestExactly:
    @EXAMPLES
    @given(st.randoms(use_true_random=False), st.integers(1, 6))
    def test_trees_of_bundles(self, source, count):
        drawn = Draw(source, count)
        drawn.tree()
        drawn.grounds(0.6)
        if drawn.members:
            assert is_forest(drawn.network)
            assert_exact(drawn)

    @EXAMPLES
    @given(st.randoms(use_true_random=False), st.integers(3, campaigns.examples(4, 6)), st.integers(1, 2))
    def test_laws_over_several_coordinates(self, source, count, wide):
        drawn = Draw(source, count)
        drawn.tree(connected=0.7)
        drawn.ties(wide, source.randint(3, 4))
        drawn.grounds(0.7)
        assert_exact(drawn)

    @pytest.mark.slow
    @EXAMPLES
    @given(st.randoms(use_true_random=False), st.integers(3, 5), st.integers(1, 3))
    def test_loops(self, source, count, extra):
        drawn = Draw(source, count)
        drawn.tree()
        drawn.ties(extra, 2)
        drawn.grounds(0.6)
        assert_exact(drawn)

    @pytest.mark.slow
    @settings(max_examples=campaigns.examples(6, 15), deadline=None)
    @given(st.randoms(use_true_random=False), st.integers(3, 4))
    def test_more_loops_than_deletion_takes(self, source, count):
        drawn = Draw(source, count)
        drawn.tree()
        drawn.ties(2, 3)
        drawn.grounds(0.6)
        with pytest.MonkeyPatch.context() as patch:
            patch.setattr(deletion_contraction, "MOST_LOOPS", 0)
            blocks = recursion_from(drawn.names[0], drawn.network, Program()).solved.values()
            assert not any(isinstance(block, SplitBlock) for block in blocks)
            assert_exact(drawn)

    def test_a_block_that_nothing_holds(self):
        """Singular with the top free, so that what the top is held with must not be divided out."""
        drawn = Draw(random.Random(2), 3)
        for names in (("q0", "q1"), ("q1", "q2"), ("q2", "q0"), ("q0", "q1")):
            drawn.law(*names, coefficients=(1, -1))
        assert drawn.matrix.det() == 0
        for most in (0, deletion_contraction.MOST_LOOPS):
            with pytest.MonkeyPatch.context() as patch:
                patch.setattr(deletion_contraction, "MOST_LOOPS", most)
                assert_exact(drawn)


class TestBlocks:
    def test_where_a_network_comes_apart(self):
        drawn = Draw(random.Random(1), 7)
        for names in (("q0", "q1"), ("q0", "q1"), ("q1", "q2", "q3"), ("q3", "q4"), ("q4", "q5"), ("q5", "q3")):
            drawn.law(*names)
        tree = orient(drawn.network, "q0")
        assert [(block.top, set(block.below)) for block in dict.fromkeys(tree.above.values())] == [
            ("q0", {"q1"}),
            ("q1", {"q2", "q3"}),
            ("q3", {"q4", "q5"}),
        ]
        assert [end for _, end in tree.path("q5")] == ["q1", "q3", "q5"]
        assert roots_of(drawn.network, "q4") == ["q4", "q6"]
        assert not is_forest(drawn.network)

    def test_loops_in_different_places_add_up(self):
        def steps(triangles):
            drawn = Draw(random.Random(1), 2 * triangles + 1)
            for i in range(triangles):
                a, b, c = drawn.names[2 * i : 2 * i + 3]
                for pair in ((a, b), (b, c), (c, a)):
                    drawn.law(*pair)
            drawn.grounds(1)
            program = Program()
            return len(program.needed([determinant(drawn.network, program)]))

        assert steps(12) - steps(6) <= 2.2 * (steps(6) - steps(3))

    def test_a_block_beyond_words(self):
        drawn = Draw(random.Random(1), 13)
        drawn.tree()
        drawn.ties(30, 2)
        with pytest.raises(tn.UsageError, match="no short expression"):
            determinant(drawn.network, Program())


@EXAMPLES
@given(st.randoms(use_true_random=False), st.integers(2, 5))
def test_single_edges_are_the_same_stiffness(source, count):
    import sympy

    drawn = Draw(source, count)
    drawn.tree()
    single = single_edges(drawn.network)
    pairs = [frozenset(member.row) for member in single.members if len(member.row) == 2]
    assert len(pairs) == len(set(pairs))
    expected, again = drawn.matrix, Draw(source, count)
    for member in single.members:
        value = sympy.sympify(member.law.stiffness).xreplace({k: drawn.number(k) for k in drawn.values})
        again.members.append(NetworkMember(member.row, Stiffness(sympy.Symbol(f"y_{len(again.members)}"))))
        again.values[again.members[-1].law.stiffness] = Fraction(int(value.p), int(value.q))
    assert again.matrix == expected


WITH_BUNDLES = ("shaft", "shaft", "planetary", "compliant_gear", "gear_in_housing", "damped_spring", "differential")


@pytest.mark.slow
@settings(max_examples=campaigns.examples(12, 40), deadline=None, suppress_health_check=list(HealthCheck))
@given(strategies.blueprints(kinds=WITH_BUNDLES, size=3, heavy=True), strategies.frequencies, st.data())
def test_shafts_and_gear_trains_against_mechanics_in_many_digits(blueprint, frequencies, data):
    drivetrain, mechanics = blueprint.drivetrain(), blueprint.mechanics
    moving = [node for node in drivetrain.nodes if mechanics.moves(node)]
    ends = [data.draw(st.sampled_from(moving)) for _ in range(2)]
    expected, sensitivity = mechanics.receptances(frequencies)
    place = (slice(None), *strategies.matching(mechanics, ends))
    H = drivetrain.symbolic().transfer_function(*ends)
    found = H.evaluate(frequencies).values[:, 0, 0]
    assert np.all(np.abs(found - expected[place]) <= 1e-10 * sensitivity[place])
