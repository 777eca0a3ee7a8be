"""Times of a fit of three parameters over three gears with 600 lines each, beside lmfit with finite differences.

python -m benchmarks.identification
"""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any

import numpy as np

import torsionnet as tn
from benchmarks._sizes import sized

GEARS = ("II", "III", "IV")
START = {"c_O": 80.0, "c_B": 4.0, "k_1": 700.0}
F = np.linspace(0.5, 30, sized(600, 60))
ROUNDS = sized(5, 1)


def tests(rig: Any) -> dict[str, Any]:
    rng = np.random.default_rng(1)
    found = {}
    for gear in GEARS:
        H = rig.configured(gear).frequency_response("theta_1", "T_T", F)
        noise = 0.01 * (rng.standard_normal(H.values.shape) + 1j * rng.standard_normal(H.values.shape))
        found[gear] = type(H)(H.frequencies, H.values * (1 + noise), H.outputs, H.inputs, H.title)
    return found


def ours(rig: Any, measured: dict[str, Any]) -> dict[str, float]:
    listed = [tn.Measurement(H, "theta_1", "T_T", gear) for gear, H in measured.items()]
    return dict(tn.identify(rig, listed, START).values)


def with_lmfit(rig: Any, measured: dict[str, Any]) -> dict[str, float]:
    """Parameters fitted with a plain residual function and lmfit's own finite differences."""
    import lmfit

    configured = {gear: rig.configured(gear) for gear in GEARS}

    def residual(parameters: Any) -> Any:
        values = {name: parameters[name].value for name in START}
        parts = []
        for gear, H in measured.items():
            model = configured[gear].configured(**values).frequency_response("theta_1", "T_T", F).values[:, 0, 0]
            parts.append((model - H.values[:, 0, 0]) / abs(H.values[:, 0, 0]))
        return np.concatenate(parts).view(float)

    parameters = lmfit.Parameters()
    for name, value in START.items():
        parameters.add(name, value=value, min=0)
    found = lmfit.minimize(residual, parameters, method="least_squares")
    return {name: float(found.params[name].value) for name in START}


def timed(call: Callable[..., dict[str, float]], *arguments: Any) -> tuple[float, dict[str, float]]:
    call(*arguments)
    took = []
    for _ in range(ROUNDS):
        began = time.perf_counter()
        found = call(*arguments)
        took.append(time.perf_counter() - began)
    return min(took), found


def main() -> None:
    rig = tn.load("amt_rig")
    measured = tests(rig)
    print(f"3 parameters, 3 gears x {len(F)} lines, seconds for the whole fit (best of {ROUNDS}):")
    own, values = timed(ours, rig, measured)
    print(f"  torsionnet.identify   {own:8.3f}   " + ", ".join(f"{name} {value:.5g}" for name, value in values.items()))
    try:
        other, theirs = timed(with_lmfit, rig, measured)
    except ImportError:
        print("  lmfit is not installed: pip install lmfit")
        return
    shown = ", ".join(f"{name} {value:.5g}" for name, value in theirs.items())
    print(f"  lmfit, differences    {other:8.3f}   {shown}")
    print(f"  ratio {other / own:.1f}; values agree to {max(abs(values[n] / theirs[n] - 1) for n in values):.1e}")


if __name__ == "__main__":
    main()
