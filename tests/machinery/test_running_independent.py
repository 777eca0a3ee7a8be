"""Order responses of random running plants against dense matrices, and half ranges against all combinations."""

import itertools

import numpy as np
import pytest
from support import campaigns
from support.dense_plants import Running, half_range

COMBINATIONS = 0.01
"""Share by which the search for the worst combination of cylinders may miss it."""


def cases_of(one, speed):
    if one.fault == "each":
        return [one.responses(speed, out=node) for node in range(one.dense.crank)]
    if one.fault == "spread":
        factors = itertools.product((0.9, 1.1), repeat=one.dense.crank)
        return [one.responses(speed, factors=those) for those in factors]
    return [one.responses(speed)]


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(campaigns.examples(12, 60)))
def test_order_response(seed):
    one = Running(seed)
    names, nodes = list(one.dense.rows), range(one.dense.n)
    run = one.plant().order_response([*(f"torque({name})" for name in names), *(f"n{node}" for node in nodes)])
    for place, speed in enumerate(run.speeds.tolist()):
        cases = cases_of(one, speed)
        orders = [line[1] for line in cases[0][0]]
        assert [line.relative for line in run.lines] == orders
        for column in range(len(run.outputs)):
            mine = np.array([np.column_stack([*torques.values(), angles])[:, column] for _, angles, torques in cases])
            scale = np.abs(mine).max()
            if len(mine) == 1:
                assert run.values[place, :, column] == pytest.approx(mine[0], abs=1e-8 * scale)
            assert run.sizes[place, :, column] == pytest.approx(np.abs(mine).max(axis=0), abs=1e-8 * scale)
            if run.revolutions is not None:
                worst = max(half_range(orders, amplitudes) for amplitudes in mine)
                found = run.half_range[place, column]
                least = worst * (1 - COMBINATIONS) if one.fault == "spread" else worst * (1 - 1e-3)
                assert least - 1e-9 * scale <= found <= worst * (1 + 1e-3) + 1e-9 * scale
