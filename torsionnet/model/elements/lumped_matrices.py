"""Element that holds matrices M, C and K of a drivetrain, split into rows with a law on each."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import lru_cache
from typing import Any, ClassVar, TypeAlias

from torsionnet.base.entries.composite import Listed
from torsionnet.base.entries.scalars import plain_number, read_scalar
from torsionnet.base.entries.spec import EntryError, Json, Renaming, Schema, Spec, entry
from torsionnet.base.errors import Fault, ModelError, got
from torsionnet.base.expressions import Number
from torsionnet.model.element_base.element import Element, register
from torsionnet.model.element_base.element_entries import TURNING_NODE
from torsionnet.model.element_base.laws import Law, Part, Row, Values, difference, make_row

ROUNDING = Fraction(8, 2**52)
"""Size of a number over the diagonal entry of its row, per row of the matrix, below which it is rounding of a sum."""
ROUNDED_NEGATIVE = Fraction(1, 10**9)
"""Negative part of a matrix over its diagonal entries that counts as zero: what calculated matrices have left."""

SquareMatrix: TypeAlias = tuple[tuple[Fraction, ...], ...]
"""Type of a square matrix by rows, in exact numbers."""


@dataclass(frozen=True, eq=False, repr=False)
class SymmetricMatrix(Spec[SquareMatrix]):
    """Entry of a symmetric matrix of numbers in rows, as ``[[13.3e3, -13.3e3], [-13.3e3, 13.76e3]]``, or an array."""

    dimension: str

    def coerce(self, raw: object) -> SquareMatrix:
        # Sparse matrices are written out; arrays, data frames and matrices of sympy have __array__.
        given: Any = raw.toarray() if hasattr(raw, "toarray") else raw
        rows = given.__array__().tolist() if hasattr(given, "__array__") else given
        if isinstance(rows, str | Mapping) or not isinstance(rows, Sequence) or not rows:
            raise EntryError(f"expected rows of numbers, as [[2, -2], [-2, 2]], {got(raw)}", kind="wrong-form")
        if any(isinstance(number, complex) for row in rows if isinstance(row, Sequence) for number in row):
            # K(j w) = K' + j K'' is K' + j w C at one frequency alone.
            text = "complex numbers hold at one frequency f; give K', and K''/(2 pi f) in the damping matrix"
            raise EntryError(text, kind="not-a-number")
        faults: list[Fault] = []
        matrix = tuple(self._row(number, row, len(rows), faults) for number, row in enumerate(rows))
        if faults:
            raise EntryError(faults)
        return matrix

    def _row(self, number: int, row: Any, size: int, faults: list[Fault]) -> tuple[Fraction, ...]:
        if isinstance(row, str | Mapping) or not isinstance(row, Sequence) or len(row) != size:
            text = f"a matrix has as many columns as rows, here {size}; row {number + 1} does not"
            faults.append(Fault(text, (number,), kind="wrong-count"))
            return ()
        numbers = []
        for column, raw in enumerate(row):
            try:
                value = read_scalar(raw, self.dimension)
                if not isinstance(value, Number):
                    raise EntryError(
                        f"a matrix holds numbers, {got(raw)}; for parameters use springs and inertias",
                        kind="expression-not-allowed",
                    )
                numbers.append(Fraction(value.value))
            except EntryError as error:
                faults += [fault.under(number, column) for fault in error.faults]
        return tuple(numbers)

    def plain(self, value: Any) -> Json:
        return [[plain_number(number) for number in row] for row in value]

    def renamed(self, value: Any, names: Renaming) -> Any:
        del names
        return value

    def schema(self) -> Schema:
        row: Schema = {"type": "array", "items": {"type": ["number", "string"]}}
        return {"type": "array", "items": row, "minItems": 1, "description": self.description}

    @property
    def accepted(self) -> str:
        return "NumberRows"


NODES = Listed("the node of each row and column", TURNING_NODE, form="a list of nodes such as [motor, disc]")


@register
@dataclass(frozen=True, eq=False, repr=False)
class LumpedMatrices(Element):
    """Matrices M, C and K of a drivetrain, or of a piece of it, that were calculated elsewhere.

    Each matrix A is split into rows a_i with a coefficient d_i >= 0, so that A = sum d_i a_i a_i^T. Where its entries
    off the diagonal are not positive and no row has a negative sum, these are the springs (inertias, dampers) between
    two nodes and to ground,

        A = sum_(i<j) (-A_ij) (e_i - e_j)(e_i - e_j)^T + sum_i (sum_j A_ij) e_i e_i^T

    and otherwise the columns of A = L D L^T (G. H. Golub and C. F. Van Loan, Matrix Computations, 4th ed., 4.2.8, with
    the largest pivot first), all in exact numbers. A matrix that is not symmetric, or in which a motion has
    negative inertia, damping or stiffness, is refused. Differences of a matrix from symmetry, and negative parts, below
    1e-9 of its diagonal count as zero, as do sums of a row that are rounding.

    Examples
    --------
    >>> pair = LumpedMatrices("rig", nodes=["a", "b"], inertia=[[2, 0], [0, 1]], stiffness=[[300, -300], [-300, 350]])
    >>> springs = [law for law in pair.parts(Values({})) if law.stiffness]
    >>> [({node: int(share) for node, share in law.row.items()}, float(law.stiffness)) for law in springs]
    [({'a': 1, 'b': -1}, 300.0), ({'b': 1}, 50.0)]
    """

    kind: ClassVar[str] = "lumped_matrices"
    glyph: ClassVar[str] = "matrices"
    may_end_anywhere: ClassVar[bool] = True
    sign: ClassVar[str] = "positive when the drivetrain drives the first node in the positive sense"

    nodes: tuple[str, ...] = entry(NODES)
    inertia: SquareMatrix | None = entry(SymmetricMatrix("inertia matrix M, symmetric, in rows", "inertia"), None)
    damping: SquareMatrix | None = entry(SymmetricMatrix("damping matrix C, symmetric, in rows", "damping"), None)
    stiffness: SquareMatrix | None = entry(SymmetricMatrix("stiffness matrix K, symmetric, in rows", "stiffness"), None)

    @property
    def ports(self) -> dict[str, str]:
        return {f"node_{number}": node for number, node in enumerate(self.nodes, 1)}

    @property
    def matrices(self) -> dict[str, SquareMatrix]:
        """Matrices that are given, by the name of their entry."""
        given = {name: getattr(self, name) for name in ("inertia", "damping", "stiffness")}
        return {name: matrix for name, matrix in given.items() if matrix is not None}

    def contradictions(self) -> list[Fault]:
        if not self.matrices:
            return [Fault("give at least one of inertia, damping and stiffness", ("inertia",), kind="missing-entry")]
        twice = next((node for node in self.nodes if self.nodes.count(node) > 1), None)
        if twice is not None:
            return [Fault(f'node "{twice}" has two rows', ("nodes", self.nodes.index(twice)), kind="repeated-name")]
        faults = []
        for name, matrix in self.matrices.items():
            if len(matrix) != len(self.nodes):
                text = f"expected a row for each node, {len(self.nodes)}, got {len(matrix)}"
                faults.append(Fault(text, (name,), kind="wrong-count"))
            else:
                faults += [fault.under(name) for fault in matrix_faults(matrix, name, self.nodes)]
        return faults

    def twist(self, value: Values) -> Row:
        """Row of the first node against the second, or of a single node's angle."""
        del value
        return difference(*self.nodes[:2]) if len(self.nodes) > 1 else make_row([(self.nodes[0], 1)])

    def own_parts(self, value: Values) -> tuple[Part, ...]:
        del value
        laws = []
        for name, matrix in self.matrices.items():
            for row, coefficient in weighted_rows(matrix)[0]:
                coefficients: dict[str, Any] = {name: coefficient}
                named: Row = {self.nodes[place]: number for place, number in row.items()}
                laws.append(Law(named, **coefficients))
        return tuple(laws)


def node_names(names: Iterable[object] | None, given: Mapping[str, Any]) -> list[str]:
    """Names of the nodes of matrices: those given, or the labels of data frames among them, or q1, q2, ...

    Raises
    ------
    ModelError
        Labels of rows or columns are others than the names, or in another order.
    """
    known = None if names is None else [str(name).replace(".", "_") for name in names]
    faults = []
    for entry_name, matrix in given.items():
        for side in ("index", "columns"):
            labels = list(getattr(matrix, side, ())) if hasattr(matrix, "columns") else []
            if not any(isinstance(label, str) for label in labels):
                continue  # numbers of rows
            own = [str(label).replace(".", "_") for label in labels]
            known = known or own
            if own != known:
                text = f"the {side} of the {entry_name} matrix is {', '.join(own)}, the nodes are {', '.join(known)}"
                faults.append(Fault(text, ("elements", "matrices", entry_name), kind="contradicting-entries"))
    if faults:
        raise ModelError(faults, "matrices")
    if known is not None:
        return known
    # What is no matrix is refused by the element.
    M = given["inertia"]
    count = (getattr(M, "shape", None) or (len(M) if isinstance(M, list | tuple) else 1,))[0]
    return [f"q{number}" for number in range(1, count + 1)]


def matrix_faults(matrix: SquareMatrix, name: str, nodes: Sequence[str]) -> list[Fault]:
    """Faults of a matrix that is not symmetric, or not positive semidefinite, by the nodes of its rows."""
    faults = []
    sizes = [abs(row[place]) for place, row in enumerate(matrix)]
    for i, row in enumerate(matrix):
        if row[i] < 0:
            faults.append(
                Fault(
                    f'the {name} of "{nodes[i]}" against itself is negative, {float(row[i]):g}',
                    (i, i),
                    kind="negative-law",
                )
            )
        for j in range(i):
            # |A_ij| <= sqrt(A_ii A_jj) in a matrix without negative parts: a measure of both.
            if abs(row[j] - matrix[j][i]) > ROUNDED_NEGATIVE * max(sizes[i], sizes[j], abs(row[j])):
                text = f"{float(matrix[j][i]):g} in row {nodes[j]} and {float(row[j]):g} in row {nodes[i]}"
                faults.append(Fault(f"the {name} matrix is not symmetric: {text}", (i, j), kind="asymmetric-matrix"))
    if faults:
        return faults
    left = weighted_rows(matrix)[1]
    if left is None:
        return []
    text = f"the {name} matrix gives a motion of {nodes[left]} with the others negative {name}"
    return [Fault(f"{text}; its rows are no springs, dampers or inertias", (left,), kind="negative-law")]


WeightedRow: TypeAlias = tuple[dict[int, Fraction], Fraction]
"""Type of a row by column, and its coefficient."""


@lru_cache(maxsize=3)
def weighted_rows(matrix: SquareMatrix) -> tuple[list[WeightedRow], int | None]:
    """Rows a_i with coefficients d_i > 0 of a symmetric matrix, A = sum d_i a_i a_i^T, and a row without, or None.

    >>> rows, left = weighted_rows(((Fraction(3), Fraction(1)), (Fraction(1), Fraction(2))))
    >>> [(dict(row), coefficient) for row, coefficient in rows], left
    ([({0: Fraction(1, 1), 1: Fraction(1, 3)}, Fraction(3, 1)), ({1: Fraction(1, 1)}, Fraction(5, 3))], None)
    """
    n = len(matrix)
    # Halves of both entries: a matrix calculated elsewhere is symmetric but for rounding.
    A = [[(matrix[i][j] + matrix[j][i]) / 2 for j in range(n)] for i in range(n)]
    sums = [sum(row, start=Fraction(0)) for row in A]
    off = [A[i][j] for i in range(n) for j in range(i)]
    if max(off, default=Fraction(0)) <= 0 and all(
        total >= -ROUNDED_NEGATIVE * row[place] for place, (total, row) in enumerate(zip(sums, A, strict=True))
    ):
        return _connections(A, sums), None
    return _factors(A)


def _connections(A: list[list[Fraction]], sums: list[Fraction]) -> list[WeightedRow]:
    """Rows of what joins two nodes, or a node to ground, in a matrix of springs, dampers or inertias."""
    n, unit = len(A), Fraction(1)
    rows = [({i: unit, j: -unit}, -A[i][j]) for i in range(n) for j in range(i + 1, n) if A[i][j]]
    return rows + [({i: unit}, sums[i]) for i in range(n) if sums[i] > n * ROUNDING * A[i][i]]


def _factors(A: list[list[Fraction]]) -> tuple[list[WeightedRow], int | None]:
    """Columns of L with the entries of D, A = L D L^T, and a row of the rest where that has a negative part."""
    n = len(A)
    sizes = [A[i][i] for i in range(n)]
    rest, terms = [row[:] for row in A], [[abs(float(number)) for number in row] for row in A]
    left, columns = set(range(n)), []
    while left:
        pivot = max(left, key=lambda i: (rest[i][i] / sizes[i] if sizes[i] else rest[i][i], -i))
        d = rest[pivot][pivot]
        if d <= n * ROUNDING * sizes[pivot]:
            break
        # What is left of entries that cancel is no coupling: it would damp a motion that no spring resists.
        coupled = [j for j in sorted(left) if abs(rest[pivot][j]) > n * ROUNDING * terms[pivot][j]]
        row = {j: rest[pivot][j] / d for j in coupled}
        columns.append((row, d))
        left.remove(pivot)
        for i, a in row.items():
            for j, b in row.items():
                rest[i][j] -= d * a * b
                terms[i][j] += abs(float(d) * float(a) * float(b))
    # What is left has no positive part; without a negative one it is rounding.
    for i in sorted(left):
        for j in left:
            if abs(rest[i][j]) > ROUNDED_NEGATIVE * max(sizes[i], sizes[j]):
                return columns, i
    return columns, None
