"""How many examples a property is tried with: few in a run without slow tests, as many as a campaign takes otherwise."""

quick = False
"""Set by conftest.py before tests are collected."""


def examples(few, many):
    """The number for this run."""
    return few if quick else many
