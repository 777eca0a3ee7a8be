"""Tests that run on a model instead of a rig."""

from torsionnet.virtual.bench import Bench
from torsionnet.virtual.files import load_bench

__all__ = ["Bench", "load_bench"]
