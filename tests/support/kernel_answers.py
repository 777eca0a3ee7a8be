"""Poles and responses of library, random and controlled models, in a process with a BLAS kernel of its own."""

import os
import random
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np

import torsionnet as tn
from support.controlled_plants import Plant
from support.random_drivetrains import draw

ROOT = Path(__file__).parents[2]
FEW = ("geared_branch", "wind_turbine_3mw")
SIZES = {"few": (2, 2), "many": (300, 100)}
"""How many random and how many controlled models."""


def library(many):
    """Library models in each configuration; two of them in their last one where few models are asked for."""
    for name in tn.library_models() if many else FEW:
        model = tn.load(name)
        names = list(model.configurations)
        if not names:
            yield name, model
        for configuration in names if many else names[-1:]:
            yield f"{name}, {configuration}", model.configured(configuration)


def drawn(count):
    """Trees with gears, closed loops and planetary sets, on the ground or free."""
    for seed in range(count):
        yield f"random {seed}", draw(random.Random(seed), loops=seed % 3, planetary=seed % 2 > 0)[0]


def controlled(count):
    """Drivetrains with one to three controllers, every second one with delays."""
    for seed in range(count):
        yield f"controlled {seed}", Plant(seed, delay=seed % 2 > 0).rig


def answers(size):
    """Kinds of modes, poles in rad/s, responses of each node to a torque on the first one, by the name of the model."""
    by_name = {}
    random_ones, controlled_ones = SIZES[size]
    for name, rig in (*library(size == "many"), *drawn(random_ones), *controlled(controlled_ones)):
        nodes = [node for node in rig.nodes if node != "ground"]
        f = np.geomspace(0.3, 300, 7)
        try:
            modes = rig.modes()
            by_name[f"{name}: kinds"] = np.array(sorted(modes.kinds))
            by_name[f"{name}: poles"] = modes.eigenvalues
            by_name[f"{name}: responses"] = rig.frequency_response(nodes, nodes[:1], f).values
        except tn.TorsionnetError as refused:
            by_name[f"{name}: refused"] = np.array(str(refused))
    return by_name


def answers_with(size, environment):
    """The same out of a new process, with these variables besides those of this one."""
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "answers.npz"
        paths = os.pathsep.join((str(ROOT), str(ROOT / "tests")))
        subprocess.run(
            [sys.executable, "-W", "ignore", "-m", "support.kernel_answers", size, file],
            env=os.environ | {"PYTHONPATH": paths} | environment,
            check=True,
        )
        return dict(np.load(file))


if __name__ == "__main__":
    np.savez(sys.argv[2], **answers(sys.argv[1]))
