"""Collecting tests loads none of the packages that take long, and reads docstring examples as doctest finds them."""

import ast
import doctest
import types

from support import collecting

TEXT = '''"""Two teeth.

>>> teeth
2
"""

teeth = 2  # >>> teeth


def turned(angle):
    """An angle without an example, and one inside that nobody reaches."""

    def inner():
        """
        >>> 1 + 1
        2
        """

    return inner, ">>> angle"


class Wheel:
    """A wheel.

    >>> Wheel().teeth
    2
    """

    class Rim:
        """
        >>> Wheel.Rim().width
        3
        """

        @property
        def width(self):
            """
            >>> 1 + 2
            3
            """
            return 3

    @classmethod
    def made(cls):
        """
        >>> Wheel.made().teeth
        2
        """
        return cls()

    teeth = 2
'''


def test_no_heavy_package_is_loaded(request):
    """Of this very run: all of its files of tests, and the helpers that they import."""
    assert not request.config.stash[collecting.LOADED]


def test_examples_are_those_of_doctest():
    module = types.ModuleType("wheels")
    exec(compile(TEXT, "wheels.py", "exec"), vars(module))
    known = {test.name for test in doctest.DocTestFinder(exclude_empty=True).find(module) if test.examples}
    places = dict(collecting.examples_in(ast.parse(TEXT), "wheels"))
    assert set(places) == known
    assert len(known) == 5
    assert TEXT.splitlines()[places["wheels.Wheel.Rim"]].strip() == "class Rim:"
