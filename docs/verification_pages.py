"""Generated part of the verification manual: an entry for every published case, made from the data of the tests.

Words stand in verification_texts.yaml; every number comes from tests/validation or from the package.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterable, Iterator
from functools import cache
from pathlib import Path
from typing import Any

import yaml
from page_parts import code, table
from verification_closed import damper_lines, passing_lines, shaft_lines
from verification_lines import MOST_LINES, Line, lines_of
from verification_orders import chain_of_five, half_ranges, wind_turbine

from support.forced_plants import NAMES, reference  # isort: skip
from validation.build import case_names, read_case  # isort: skip

HEADINGS = ["quantity", "reference by", "reference", "calculated", "deviation", "allowed"]
MOST_NODES = 12
"""Inertias of a case that its entry lists; longer chains are described in words."""
KEPT_TOGETHER = "```{raw} latex\n\\needspace{8\\baselineskip}\n```\n"
"""Text that begins a new page on paper where fewer than eight lines are left, so that no heading ends a page."""
ORACLE_MODELS = 3
"""Random drivetrains that are compared with exact mechanics while the manual is made; more would take minutes."""


def verification_page() -> str:
    """Text of the verification manual below its introduction."""
    cases = {name: read_case(name) for name in case_names()}
    entries = {name: lines_of(case) for name, case in cases.items() if "expected" in case}
    forced = {"forced_ot_docs_chain5": chain_of_five(), "forced_sopanen_windmill": wind_turbine()}
    orders = {name: list(half_ranges(name)) for name in NAMES}
    closed = [*damper_lines(), *shaft_lines(), *passing_lines()]
    of_orders = {name: [line for _, lines in found for line in lines] for name, found in orders.items()}
    parts = ["## Summary\n", _summary({**entries, **forced, **of_orders, "closed forms": closed})]
    parts += ["## The test rigs of the source paper\n", _rigs()]
    parts += ["## Natural frequencies, damping and receptances\n"]
    parts += [_entry(name, cases[name], lines) for name, lines in entries.items()]
    parts += ["## Forced responses\n", *(_entry(name, cases[name], lines) for name, lines in forced.items())]
    parts += ["## Order responses\n", *(_order_entry(name, found) for name, found in orders.items())]
    parts += ["## Closed forms\n", _closed(closed)]
    parts += ["## Independent programs\n", _programs(cases), _oracle()]
    return "\n".join(parts)


@cache
def texts() -> dict[str, dict[str, str]]:
    """Words of every entry of the verification manual, by the name of its case."""
    found: dict[str, dict[str, str]] = yaml.safe_load((Path(__file__).parent / "verification_texts.yaml").read_text())
    return found


def all_hold(lines: Iterable[Line]) -> bool:
    return all(line.holds for line in lines)


def _summary(entries: dict[str, list[Line]]) -> str:
    """Table with one row for each entry, and a sentence on all of them."""
    rows = []
    for name, lines in entries.items():
        printed = [line for line in lines if line.absolute]
        others = [line for line in lines if not line.absolute]
        worst = f"{max(line.deviation for line in others):.1e}" if others else "-"
        title = texts()[name]["title"] if name in texts() else name.capitalize()
        verdict = "agrees" if all_hold(lines) else "DIFFERS"
        rows.append([title, str(len(printed)) if printed else "-", str(len(others)), worst, verdict])
    lines = [line for some in entries.values() for line in some]
    beyond = [line for line in lines if not line.holds]
    sentence = (
        f"{len(entries)} entries compare {len(lines)} values, {sum(line.absolute for line in lines)} of them with "
        f"printed numbers; {len(beyond) or 'none'} of them differ by more than the test allows.\n"
    )
    headings = ["entry", "printed values", "other values", "largest relative deviation of these", "verdict"]
    return sentence + "\n" + table(headings, rows)


def _rigs() -> str:
    from validation_pages import paper_page

    return (
        "Galvagno, Tota, Velardocchia and Vigliani (2015) tested a dual-mass flywheel and an automated manual "
        "transmission. *Deviation* is of the model from their test, *why* explains it; the page [](validation.md) "
        "discusses each difference.\n\n" + paper_page()
    )


def _entry(name: str, case: dict[str, Any], lines: list[Line]) -> str:
    words = texts()[name]
    parts = [f"### {words['title']}\n", f"{words['shows']}\n", f"* Case: {code(name)}", f"* Source: {_source(case)}"]
    if "nodes" in case:
        parts += [f"* Data: {case['description'].rstrip('.')}.\n", _model(case)]
    else:
        parts += [f"* Model: that of *{texts()[case['model']]['title']}*; {case['description']}.\n"]
    parts += [KEPT_TOGETHER, "**Values.**\n", lines_table(lines)]
    if "why" in words:
        parts += [f"**Where values differ.** {words['why']}\n"]
    return "\n".join(parts)


def _source(case: dict[str, Any]) -> str:
    """Source of a case, without the page on which its number was found; names of programs are no links."""
    return re.sub(r"; the two-node value.*", "", case["source"]).replace("_", "\\_").rstrip(".") + "."


def _model(case: dict[str, Any]) -> str:
    """Tables of the inertias and connections of a case, or a sentence for a long chain."""
    unit = "" if "per-unit" in case["description"] else " [kg m²]"
    if len(case["nodes"]) > MOST_NODES:
        return f"**Model.** {len(case['nodes'])} nodes and {len(case['springs'])} springs, all alike.\n"
    bodies = table(
        ["node", f"inertia{unit}", "damping to ground"],
        [[node["name"], digits(node["inertia"]), digits(node["damping_to_ground"])] for node in case["nodes"]],
    )
    joined = [
        [spring["from"], spring["to"], "spring", "-", digits(spring["stiffness"]), digits(spring["damping"])]
        for spring in case["springs"]
    ]
    joined += [
        [
            gear["from"],
            gear["to"],
            "gear",
            digits(gear["ratio"]),
            *(_mesh(gear, key) for key in ("stiffness", "damping")),
        ]
        for gear in case["gears"]
    ]
    joined += [[node, "ground", "lock", "-", "rigid", "-"] for node in case["grounded"]]
    headings = ["from", "to", "what", "ratio", "stiffness", "damping"]
    text = f"{KEPT_TOGETHER}\n**Model.**\n\n{bodies}\n" + (table(headings, joined) + "\n" if joined else "")
    planets = case.get("planetary")
    if planets:
        text += "Meshes: " + ", ".join(f"{code(key)} {value}" for key, value in planets.items()) + ".\n"
    return text


def digits(value: float) -> str:
    """Text of a number of a model with the ten digits that its file has."""
    return f"{value:.10g}"


def _mesh(gear: dict[str, Any], key: str) -> str:
    return digits(gear[key]) if key in gear else {"stiffness": "rigid", "damping": "-"}[key]


def lines_table(lines: list[Line]) -> str:
    """Table of values; of more than a few of one kind the others stand in one row with their largest deviation."""
    rows = []
    groups: dict[tuple[str, str, float, bool], list[Line]] = {}
    for line in lines:
        groups.setdefault((line.source, line.unit, line.allowed, line.absolute), []).append(line)
    for (source, unit, _, _), some in groups.items():
        shown = some if len(some) <= MOST_LINES + 1 else some[:MOST_LINES]
        rows += [line.cells for line in shown]
        rest = some[len(shown) :]
        if rest:
            worst = max(rest, key=lambda line: line.deviation)
            what = f"{len(rest)} more" + (f" [{unit}]" if unit else "") + f"; worst {worst.cells[0]}"
            rows.append([what, source, *worst.cells[2:]])
    return values_table(HEADINGS, rows)


COLUMNS = {6: (26, 13, 17, 17, 14, 13), 4: (40, 22, 22, 16)}
"""Widths on paper of the columns of a table of values, in percent, by their number."""


def values_table(headings: list[str], rows: list[list[str]]) -> str:
    """Markdown of a table of values with the widths of its columns on paper, where it may break over pages."""
    widths = "".join(rf"\Y{{{percent / 100:g}}}" for percent in COLUMNS[len(headings)])
    return f"```{{tabularcolumns}} {widths}\n```\n\n```{{rst-class}} longtable\n```\n\n{table(headings, rows)}"


def _order_entry(name: str, found: list[tuple[str, list[Line]]]) -> str:
    words, data = texts()[name], reference(name)
    engine = data["engine"]
    text = [f"### {words['title']}\n", f"{words['shows']}\n", f"* Case: {code(name)}", f"* Source: {data['source']}."]
    text += [
        f"* Model: {len(data['model']['nodes'])} inertias, {len(data['model']['springs'])} connections; "
        f"{engine['cycle']}-stroke engine, firing order {'-'.join(map(str, engine['firing_order']))}, bore "
        f"{engine['bore']:g} m, stroke {engine['stroke']:g} m, {len(data['orders'])} orders.",
        f"* Convention: {data['convention'].rstrip('.')}.\n",
    ]
    for condition, lines in found:
        ranges = [line for line in lines if line.quantity.startswith("half range")]
        singles = [line for line in lines if line not in ranges]
        worst = max(singles, key=lambda line: line.deviation)
        headings = ["half range [N m]", "reference", "calculated", "deviation"]
        shown = [[line.quantity.removeprefix("half range of "), *line.cells[2:5]] for line in ranges]
        text += [f"**{condition.capitalize()}.** Allowed: {ranges[0].allowed:g}.\n", values_table(headings, shown)]
        text += [
            f"\n{len(singles)} complex amplitudes of single orders were compared; the largest relative deviation is "
            f"{worst.deviation:.1e} ({worst.quantity}), allowed {worst.allowed:g}.\n"
        ]
    return "\n".join([*text, f"**Where values differ.** {words['why']}\n"])


def _closed(lines: list[Line]) -> str:
    return (
        "The best untuned damper has its peak where the responses of a locked and of a free ring meet (J. P. Den "
        "Hartog, *Mechanical Vibrations*, 4th ed., chapter 3); O. Nishihara and T. Asami (J. Vib. Acoust. 124, 2002, "
        "576) give the exact optimum of the tuned one. $\\zeta$ is $c/(2 J_r \\omega_1)$ of the untuned and "
        "$c/(2 J_r \\omega_r)$ of the tuned ring, the peak is over the static angle.\n\n"
        + values_table(HEADINGS, [line.cells for line in lines])
    )


PROGRAMS = {
    "openTorsion": r"openTorsion",
    "Drivetrain-python": r"Drivetrain-python",
    "Modelica Standard Library": r"Modelica",
    "AppliedVibrationAnalysis": r"AppliedVibrationAnalysis",
    "scripts for Matlab or other public scripts": r"public (?:MATLAB )?script",
    "closed forms": r"closed form|constructed",
}
"""Programs that the sources of cases name, with the pattern that finds them."""


def _programs(cases: dict[str, dict[str, Any]]) -> str:
    counts = Counter(
        program
        for case in cases.values()
        for program, pattern in PROGRAMS.items()
        if re.search(pattern, case["source"])
    )
    rows = [[program, str(counts[program])] for program in PROGRAMS if counts[program]]
    plants = len(NAMES)
    return (
        "The sources of the cases above name other programs, whose numbers or data they carry:\n\n"
        + table(["program", "cases"], rows)
        + f"\nThe {plants} plants with orders were solved by a dense complex solve that shares no code with the "
        "package, and confirmed by integration over time.\n"
    )


def _oracle() -> str:
    """Table of random drivetrains against exact mechanics, made on the spot."""
    try:
        from oracle.campaign import compare
        from oracle.tally import Tally
    except ImportError as missing:
        return (
            f"Random drivetrains against exact mechanics were not compared here: {missing}. `make compare` does it.\n"
        )
    tally = Tally()
    for number_of_model in range(ORACLE_MODELS):
        compare(f"manual-{number_of_model}", tally)
    rows = [
        [name, str(line.values), f"{line.worst:.1e}", f"{line.tolerance:g}", str(line.beyond)]
        for name, line in tally.lines.items()
        if line.values
    ]
    return (
        "### Random drivetrains against exact mechanics\n\n"
        "`tests/oracle` writes one equation for each node and each rigid condition from the laws, and solves them in "
        f"ball arithmetic of 150 digits. It shares no code with the package. {ORACLE_MODELS} models drawn while this "
        "page was made; `make compare` draws any number, and [](validation.md) tells of campaigns with hundreds.\n\n"
        + table(["quantity", "values", "largest deviation", "tolerance", "beyond it"], rows)
    )


def entry_names() -> Iterator[str]:
    """Names of all cases that have an entry in the verification manual."""
    yield from (*case_names(), *NAMES)
