"""Generated tables of the validation page: the rigs of the source paper, and the published cases."""

from __future__ import annotations

import importlib
import math
import re
import sys
from dataclasses import replace
from pathlib import Path
from typing import Any

from page_parts import code, table

import torsionnet as tn

DOCS = Path(__file__).parent
TESTS = DOCS.parent / "tests"
sys.path.append(str(DOCS.parent / "examples" / "demo"))


def demo_rigs() -> Any:
    """Module of the demonstration with the rigs of the source paper."""
    return importlib.import_module("rigs")


def paper_page() -> str:
    """Table of the rigs of the source paper: the model against the results of its test."""
    rigs = demo_rigs().rigs()
    rows = []
    for rig in rigs:
        for quantity, unit, value in demo_rigs().quantities(rig):
            printed = demo_rigs().PAPER.get((rig.case, quantity))
            if printed is not None:
                apart = f"{value - printed:+.1f} deg" if unit == "deg" else f"{100 * (value / printed - 1):+.1f} %"
                shown = [f"{printed:g} {unit}".removesuffix(" 1"), f"{value:.5g} {unit}".removesuffix(" 1"), apart]
                rows.append([rig.case, quantity, *shown, WHY[quantity]])
    headings = ["case", "quantity", "paper's test", "model", "deviation", "why"]
    return table(headings, rows) + "\n" + model_table(rigs)


WHY = {
    "peak frequency": "printed to 1 Hz; the estimate has a line every 0.5 Hz",
    "peak phase": "a viscous damper stands for losses that do not depend on frequency",
    "damping ratio": "the model's is that of the whole rig, see below",
    "DC gain": "$1/k_1 + \\tau^2/k_2$ with the same two stiffnesses in every gear",
}


def model_table(rigs: list[Any]) -> str:
    rows, curves = [], []
    for rig in rigs:
        whole, cut = rig.drivetrain.modes(), rig.drivetrain.modes(measured_input="T_T")
        rows.append([rig.case, poles(whole), poles(cut)])
        found = {quantity: value for quantity, _, value in demo_quantities(rig)}
        peak = f"{found['peak value']:.4f} at {found['peak frequency']:.3f} Hz, {found['peak phase']:.1f} deg"
        curves.append([rig.case, f"{found['DC gain']:.4f}", peak, f"{lag(rig, 0.4):.1f}", f"{lag(rig, 12.0):.1f}"])
    headings = ["case", "whole rig", "cut at the torque meter"]
    curve = ["case", "static [deg/(N m)]", "peak [deg/(N m)]", "phase at 0.4 Hz [deg]", "phase at 12 Hz [deg]"]
    return (
        "Poles of the models, $|\\lambda|/2\\pi$ and damping ratio:\n\n"
        + table(headings, rows)
        + "\nTheir transfer functions $\\theta_1/T_T$:\n\n"
        + table(curve, curves)
    )


def demo_quantities(rig: Any) -> Any:
    return demo_rigs().quantities(rig)


def poles(modes: tn.Modes) -> str:
    found = []
    for index, kind in enumerate(modes.kinds):
        if kind == "oscillatory":
            found.append(f"{modes.natural_frequencies[index]:.5f} Hz, {100 * modes.damping_ratios[index]:.2f} %")
        else:
            found.append(f"real pole {modes.eigenvalues[index].real:.6g} rad/s")
    return "; ".join(found)


def lag(rig: Any, frequency: float) -> float:
    return float(rig.drivetrain.frequency_response("theta_1", "T_T", [frequency]).phase.item())


PER_HZ = {
    "natural_frequencies_hz": ("Hz", 1.0),
    "natural_frequencies_cpm": ("1/min", 60.0),
    "natural_frequencies_rad_s": ("rad/s", 2 * math.pi),
}


def cases_page() -> str:
    """Tables of the published numbers, and of the cases with a reference computed to 40 digits."""
    if str(TESTS) not in sys.path:
        sys.path.insert(0, str(TESTS))
    from validation.build import build, case_names, read_case

    cases = {name: read_case(name) for name in case_names()}
    printed, computed, sources = [], [], []
    for name, case in cases.items():
        if "expected" not in case:
            continue
        modes = build(case).modes()
        rows = published_rows(name, case, modes)
        printed += rows
        sources += [f"* {code(name)}: {source_of(case)}"] if rows else []
        computed.append(computed_row(name, case, modes))
    headings = ["case", "quantity", "published", "computed", "relative"]
    reference = ["case", "what it is", "compared", "values", "largest relative deviation"]
    return (
        "### Printed numbers\n\nUndamped natural frequencies $f_n$ and damping ratios $\\zeta_n$.\n\n"
        + table(headings, printed)
        + "\nSources, and where the numbers were taken from:\n\n"
        + "\n".join(sources)
        + "\n"
        + "\n### Reference solutions of the same data\n\n"
        + table(reference, computed)
    )


def source_of(case: dict[str, Any]) -> str:
    """Source of the numbers of a case, without notes on how its file was found."""
    return re.sub(r"; the two-node value.*", "", case["source"])


def published_rows(name: str, case: dict[str, Any], modes: tn.Modes) -> list[list[str]]:
    rows = []
    published = case.get("published") or {}
    first = [code(name)]
    for key, (unit, scale) in PER_HZ.items():
        for index, value in enumerate(published.get(key, ())):
            if value in (None, 0):
                continue
            found = modes.undamped_natural_frequencies[index] * scale
            rows.append([*first, f"$f_{{{index + 1}}}$ [{unit}]", *compared(value, found)])
            first = [""]
    ratios = [ratio for ratio, kind in zip(modes.damping_ratios, modes.kinds, strict=True) if kind == "oscillatory"]
    for index, value in enumerate(published.get("damping_ratios", ())):
        rows.append([*first, f"$\\zeta_{{{index + 1}}}$", *compared(value, ratios[index])])
        first = [""]
    return rows


def compared(value: float | str, found: float) -> list[str]:
    shown = f"{float(value):.10g}"
    return [shown, f"{found:.10g}", f"{found / float(value) - 1:+.1e}"]


def computed_row(name: str, case: dict[str, Any], modes: tn.Modes) -> list[str]:
    expected = case["expected"]
    damped = "damping_ratios" in expected
    picked = [i for i, kind in enumerate(modes.kinds) if kind == "oscillatory" or not damped]
    pairs = list(zip(modes.natural_frequencies[picked], expected["natural_frequencies_hz"], strict=True))
    what = "natural frequencies"
    if damped:
        pairs += zip(modes.damping_ratios[picked], expected["damping_ratios"], strict=True)
        what += ", damping ratios"
    worst = max(abs(found / value - 1) for found, value in pairs if value)
    return [code(name), case["description"].partition(";")[0], what, str(len(pairs)), f"{worst:.1e}"]


# The virtual bench


def bench_numbers_page() -> str:
    """Table of estimates from the virtual bench against the model, with a fine and with the paper's encoder."""
    cases = [("DMF", tn.load_bench("dmf_bench"))]
    cases += [(f"AMT {gear}", tn.load_bench("amt_bench").configured(gear)) for gear in ("II", "III", "IV", "V")]
    fine = table(
        ["case", "usable up to", "peak of the estimate", "of the model", "largest difference", "largest difference"],
        [[case, *_agreement(bench)] for case, bench in cases],
    )
    coarse = table(
        ["case", "usable up to", "largest bias beyond, while coherent", "coherence under 0.8 from"],
        [[case, *_collapse(bench)] for case, bench in cases],
    )
    return (
        "With 1024 lines in quadrature, 4096 steps:\n\n"
        + fine
        + "\nWith 1024 steps, as on the paper's bench:\n\n"
        + coarse
        + "\nA rig at rest on the edge of a step toggles between two of them: the estimate stays coherent and is "
        "far too large (*never*). In the middle of a step it sees nothing.\n"
    )


def _agreement(bench: Any) -> list[str]:
    import numpy as np

    from torsionnet.bench.plan import Encoder
    from torsionnet.signals import difference

    channels = {**bench.plan.channels, "theta_1": Encoder(lines=1024, quadrature=True)}
    test, model = _estimate(replace(bench, plan=replace(bench.plan, channels=channels)))
    limit = test.usable_up_to
    good, apart = test.between(0.5, limit), difference(test.between(0.5, limit), model.between(0.5, limit))
    peak = good.frequencies[good.magnitude[:, 0, 0].argmax()]
    fine = np.linspace(0.5, 20, 4000)
    curve = bench.drivetrain.frequency_response("theta_1", "T_T", fine).magnitude[:, 0, 0]
    worst = f"{abs(apart.decibels).max():.2f} dB", f"{abs(apart.degrees).max():.1f} deg"
    return [f"{limit:.1f} Hz", f"{peak:g} Hz", f"{fine[curve.argmax()]:.2f} Hz", *worst]


def _collapse(bench: Any) -> list[str]:
    from torsionnet.signals import difference
    from torsionnet.signals.uncertainty import LEAST_COHERENCE

    test, model = _estimate(bench)
    f, coherence = test.frequencies, test.coherence[:, 0, 0]
    incoherent = f[(coherence < LEAST_COHERENCE) & (f > test.usable_up_to)]
    lost = float(incoherent[0]) if len(incoherent) else math.inf
    apart = abs(difference(test, model).decibels[:, 0, 0])
    beyond = (f > test.usable_up_to) & (f < lost - 1)
    since = f"{lost:g} Hz" if len(incoherent) else "never"
    return [f"{test.usable_up_to:.1f} Hz", f"{apart[beyond].max():.1f} dB", since]


def _estimate(bench: Any) -> tuple[Any, Any]:
    from torsionnet.signals import PAPER, estimate

    test = estimate(bench.run(), "theta_1", "T_T", settings=PAPER).between(0.5, 40)
    return test, bench.drivetrain.frequency_response("theta_1", "T_T", test.frequencies)
