"""Polynomials and determinants modulo a large prime, and rational numbers from their residues.

Whether a determinant is zero or a root repeated costs machine words modulo a prime of 61 bits, where fractions would
grow without bound; the answer is wrong for one prime in about 1e16. Coefficients are lists, ascending, without zeros at
the end.

>>> prime = next(primes())
>>> cubed = [2 % prime, 5, 4, 1]  # (x + 1)^2 (x + 2)
>>> square_free(cubed, prime)
{1: [2, 1], 2: [1, 1]}
>>> rational_from_residue(residue(Fraction(-22, 7), prime), prime)
Fraction(-22, 7)
"""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction
from math import isqrt
from typing import TypeAlias

Coefficients: TypeAlias = list[int]


def primes() -> Iterator[int]:
    """Yield the primes up to 2^61 - 1 in descending order."""
    number = 2**61 - 1
    while True:
        if _is_prime(number):
            yield number
        number -= 2


def _is_prime(number: int) -> bool:
    """Whether an odd number is prime, by Miller-Rabin with bases that decide every number below 3e24."""
    # number - 1 = odd * 2^halvings
    odd, halvings = number - 1, 0
    while odd % 2 == 0:
        odd, halvings = odd // 2, halvings + 1
    for base in (2, 3, 5, 7, 11, 13, 17, 19, 23, 29, 31, 37, 41):
        power = pow(base, odd, number)
        if power not in (1, number - 1) and all(pow(base, odd << k, number) != number - 1 for k in range(1, halvings)):
            return False
    return True


def residue(value: Fraction, prime: int) -> int:
    """Residue of a rational number modulo a prime, from 0 to prime - 1."""
    return value.numerator * pow(value.denominator, -1, prime) % prime


def rational_from_residue(value: int, modulus: int) -> Fraction | None:
    """Rational number with small numerator and denominator that has this residue, or None without one."""
    # Euclid's algorithm, stopped at sqrt(modulus / 2), below which numerator and denominator are unique.
    bound = isqrt(modulus // 2)
    r, s = (modulus, value % modulus), (0, 1)
    while r[1] > bound:
        quotient = r[0] // r[1]
        r, s = (r[1], r[0] - quotient * r[1]), (s[1], s[0] - quotient * s[1])
    return Fraction(r[1], s[1]) if s[1] and abs(s[1]) <= bound else None


# --- determinants ---------------------------------------------------------------------------------------------------


def determinant(rows: list[dict[int, int]], prime: int) -> int:
    """Determinant modulo a prime of a sparse matrix of residues, by elimination, which overwrites the rows."""
    result, places = 1, list(range(len(rows)))
    for column in range(len(rows)):
        holders = [place for place in places[column:] if column in rows[place]]
        if not holders:
            return 0
        # The row with the fewest entries fills up the others least.
        pivot = min(holders, key=lambda place: len(rows[place]))
        at = places.index(pivot, column)
        if at != column:
            places[at], places[column] = places[column], pivot
            result = -result
        head = rows[pivot].pop(column)
        result = result * head % prime
        inverse = pow(head, -1, prime)
        for place in holders:
            if place != pivot:
                _subtract(rows[place], rows[pivot], rows[place].pop(column) * inverse, prime)
    return result


def _subtract(row: dict[int, int], other: dict[int, int], factor: int, prime: int) -> None:
    for column, value in other.items():
        left = (row.get(column, 0) - factor * value) % prime
        if left:
            row[column] = left
        else:
            row.pop(column, None)


def interpolating_polynomial(values: list[int], prime: int) -> Coefficients:
    """Coefficients modulo a prime, ascending, of the polynomial with these values at 0, 1, 2, ..."""
    # Newton's divided differences, modulo the prime.
    differences = list(values)
    for order in range(1, len(values)):
        inverse = pow(order, -1, prime)
        for i in range(len(values) - 1, order - 1, -1):
            differences[i] = (differences[i] - differences[i - 1]) * inverse % prime
    # Horner's rule over the points gives the coefficients.
    result: Coefficients = []
    for point in range(len(values) - 1, -1, -1):
        shifted = [0, *result]
        result = [(low - point * high) % prime for low, high in zip(shifted, [*result, 0], strict=True)]
        result[0] = (result[0] + differences[point]) % prime
    return _trimmed(result)


# --- repeated roots -------------------------------------------------------------------------------------------------


def square_free(polynomial: Coefficients, prime: int) -> dict[int, Coefficients]:
    """Monic polynomials of the roots of each multiplicity, modulo a prime, by that multiplicity.

    The square-free factorisation is that of D. Y. Y. Yun, 1976.
    """
    by_multiplicity: dict[int, Coefficients] = {}
    slope = _derivative(polynomial, prime)
    # Yun: gcd(p, p') has every root once less; p and p' without it part the multiplicities one by one.
    common = _greatest_divisor(polynomial, slope, prime)
    rest, other = _divided(polynomial, common, prime)[0], _divided(slope, common, prime)[0]
    multiplicity = 1
    while len(rest) > 1:
        other = _difference(other, _derivative(rest, prime), prime)
        factor = _greatest_divisor(rest, other, prime)
        if len(factor) > 1:
            by_multiplicity[multiplicity] = factor
        rest, other = _divided(rest, factor, prime)[0], _divided(other, factor, prime)[0]
        multiplicity += 1
    return by_multiplicity


def _trimmed(values: Coefficients) -> Coefficients:
    while values and not values[-1]:
        values.pop()
    return values


def _derivative(values: Coefficients, prime: int) -> Coefficients:
    return [power * value % prime for power, value in enumerate(values)][1:]


def _difference(a: Coefficients, b: Coefficients, prime: int) -> Coefficients:
    longest = max(len(a), len(b))
    a, b = ([*values, *[0] * (longest - len(values))] for values in (a, b))
    return _trimmed([(x - y) % prime for x, y in zip(a, b, strict=True)])


def _divided(a: Coefficients, b: Coefficients, prime: int) -> tuple[Coefficients, Coefficients]:
    """Quotient and remainder of two polynomials modulo a prime, with ascending coefficients."""
    rest, inverse = list(a), pow(b[-1], -1, prime)
    quotient = [0] * max(len(a) - len(b) + 1, 0)
    # Long division from the highest power on; dividing is multiplying by the inverse.
    for power in range(len(quotient) - 1, -1, -1):
        factor = quotient[power] = rest[power + len(b) - 1] * inverse % prime
        for i, value in enumerate(b):
            rest[power + i] = (rest[power + i] - factor * value) % prime
    return _trimmed(quotient), _trimmed(rest)


def _greatest_divisor(a: Coefficients, b: Coefficients, prime: int) -> Coefficients:
    """Monic greatest common divisor of two polynomials modulo a prime, with ascending coefficients."""
    while b:
        a, b = b, _divided(a, b, prime)[1]
    inverse = pow(a[-1], -1, prime)
    return [value * inverse % prime for value in a]
