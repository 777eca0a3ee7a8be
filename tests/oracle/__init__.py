"""Random drivetrains compared with an assembly of their own, in hundreds of digits.

A :class:`~oracle.description.Model` is plain data with exact numbers. ``package`` makes a drivetrain of it through the
public API; ``physics``, ``elimination``, ``solution`` and ``poles`` calculate the same from the laws of the elements,
with one equation for every node and every rigid condition, and take nothing from the package. ``campaign`` draws
models (``drawing``), asks questions (``questions``), compares (``comparison``) and counts (``tally``, ``roles``).

Run ``python -m oracle --models 300`` in the folder ``tests``, or ``make compare``.
"""
