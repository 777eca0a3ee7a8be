"""Reference of the Python interface: a page for each public object, and an index by subject with first sentences."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

from public_names import PublicName, public_names
from public_uses import sources_of_results, uses_of_names

import torsionnet as tn

MODEL = (
    *("Drivetrain", "Parameter", "Input", "Sensor", "load", "loads", "library_models"),
    *("ShortCircuitScenario", "TorqueScenario"),
)
RESULTS = (
    *("Adaptive", "Channel", "Column", "Conventions", "FrequencyResponse", "FrequencyResponses"),
    *("Modes", "Table"),
)
DAMPING = ("convert_damping",)
IDENTIFICATION = ("identify", "Measurement", "Unknown", "Fit")
BENCHES = ("Bench", "load_bench", "library_benches")
SUBJECTS: tuple[tuple[str, str, tuple[str, ...]], ...] = (
    ("Model", "", MODEL),
    ("Elements", "Their entries with units and bounds are on the page [Elements](elements.md).", ("element types",)),
    ("Own element types", "[](how_to/own_elements.md) shows their use.", ("extend",)),
    ("Responses and modes", "", ("linear", *RESULTS)),
    ("Running machinery", "", ("machinery",)),
    ("Motion over time", "", ("motion",)),
    ("Signals", "Records of a test bench, real or simulated; [](test_bench.md) explains them.", ("signals",)),
    (
        "Modes of frequency responses",
        "Identified without a model; [](how_to/identify_modes.md) shows their use.",
        ("modal",),
    ),
    ("Identification", "", (*IDENTIFICATION, "identification", "linear.sensitivity")),
    ("Virtual benches", "", (*BENCHES, "bench")),
    (
        "Campaigns",
        "Rotating tests; [](how_to/campaign.md) walks through one.",
        ("load_campaign", "run_campaign", "bench.campaign"),
    ),
    ("Symbols", "", ("symbolic",)),
    ("Plots", "Each function returns a figure of matplotlib.", ("plot",)),
    (
        "Studies",
        "Quantities, answers and variations are written as in [a study file](study_file.md).",
        ("load_study", "study"),
    ),
    ("Reports", "", ("write_report", "report")),
    (
        "Interchange",
        "Which file goes to which program is on [its page](how_to/interchange.md).",
        ("io", "Catalogue", "MassElasticSheet"),
    ),
    ("Damping and units", "Units are `tn.units`.", (*DAMPING, "base.units")),
    ("Errors", "", ("errors",)),
)
"""Heading, sentence and contents of every part of the index: names of ``tn``, packages, element types and errors."""
STYLE_PAGE = """\
.. py:data:: torsionnet.plot.STYLE
   :type: dict[str, Any]

   The look of the pictures as settings of matplotlib, for figures of one's own: ``plt.style.use(plot.STYLE)``.
"""
REDIRECT = """\
<script>
/* Links to the one page that the reference was lead on to the page of the object. */
(() => {
  const wanted = decodeURIComponent(location.hash.slice(1));
  for (let name = wanted; name; name = name.slice(0, Math.max(0, name.lastIndexOf(".")))) {
    const link = document.getElementById(name)?.parentElement.querySelector("a.reference");
    if (link) { location.replace(`${link.href.split("#")[0]}#${wanted}`); return; }
  }
})();
</script>
"""


def subject_of(one: PublicName) -> str:
    """Heading under which the index has an object."""
    package, _, last = one.name.removeprefix("torsionnet.").rpartition(".")
    if isinstance(one.value, type) and issubclass(one.value, tn.Element):
        package = "element types"
    if one.value.__class__ is type and one.value.__module__ == "torsionnet.base.errors":
        package = "errors"
    also = {other.removeprefix("torsionnet.").rpartition(".")[0] for other in one.others}
    for heading, _, contents in SUBJECTS:
        if last in contents and (not package or one.is_result):
            return heading
    rooms = [package.rsplit(".", cut)[0] for cut in range(package.count(".") + 1)] if one.is_result else [package]
    for room in rooms:  # of a result the nearest one above its module
        for heading, _, contents in SUBJECTS:
            if room in contents or (not room and also & {*contents}):
                return heading
    raise ValueError(f"no subject of the reference has {one.name}")


def page_names() -> dict[str, PublicName]:
    """Public objects by the names of their pages, which differ by more than capitals."""
    found: dict[str, PublicName] = {}
    taken = set()
    for one in sorted(public_names(), key=lambda one: not one.is_class):
        name = one.name if one.name.casefold() not in taken else f"{one.name}_function"
        taken.add(name.casefold())
        found[name] = one
    return found


def shown_name(one: PublicName) -> str:
    """Name as a program writes it after ``import torsionnet as tn``; of a result the class alone."""
    if one.is_result:
        return one.last
    package, _, last = one.name.removeprefix("torsionnet.").rpartition(".")
    return ".".join(["tn", *([package.rpartition(".")[2]] if package else []), last])


def reference_index() -> str:
    """Markdown of the index by subject."""
    pages = {subject: [] for subject, _, _ in SUBJECTS}
    for page, one in page_names().items():
        pages[subject_of(one)].append((page, one))
    return "\n".join([*(_part(*subject[:2], pages[subject[0]]) for subject in SUBJECTS), REDIRECT])


def _part(heading: str, sentence: str, objects: list[tuple[str, PublicName]]) -> str:
    names = [(page, one) for page, one in objects if not one.is_result]
    results = [(page, one) for page, one in objects if one.is_result]
    lines = [f"## {heading}\n", f"{sentence}\n" if sentence else ""]
    if names:
        lines += ["| name | what it is | used in |", "|---|---|---|", *_rows(names), ""]
    if results:
        lines += ["| result | what it is | comes from |", "|---|---|---|", *_rows(results), ""]
    return "\n".join(lines)


def _rows(objects: list[tuple[str, PublicName]]) -> Iterator[str]:
    for page, one in sorted(objects, key=lambda pair: pair[1].name.casefold()):
        places = "".join(f'<span id="{place}"></span>' for place in dict.fromkeys(_places(one)))
        summary = one.summary or _plain_summary(one)
        yield f"| {places}[`{shown_name(one)}`](reference/{page}.md) | {_markdown(summary)} | {_reason(one)} |"


def _reason(one: PublicName) -> str:
    """Task that needs a public object: the page or example that shows it, or the call that returns it."""
    if one.is_result:
        return f"`{sources_of_results()[one.last][0]}`"
    # Only an element type just added is used nowhere: `make lint` names every other public name without a task.
    return str(uses_of_names().get(one.name, ["[Elements](elements.md)"])[0])


def _places(one: PublicName) -> Iterator[str]:
    """Names of an object that links to the reference may have."""
    yield one.name
    yield from one.others
    if one.is_class or callable(one.value):
        yield f"{one.value.__module__}.{one.value.__qualname__}"


def _plain_summary(one: PublicName) -> str:
    return {"STYLE": "The look of the pictures as settings of matplotlib."}.get(one.last, "Constant.")


def _markdown(text: str) -> str:
    return text.replace("``", "`").replace("|", r"\|").replace("*", r"\*")


def object_page(one: PublicName) -> str:
    """Markdown of the page of a public object."""
    others = ", ".join(f"`{other}`" for other in one.others)
    return "\n".join(
        [
            "---\norphan: true\n---\n",
            f"# {shown_name(one)}\n",
            f"[Reference](../reference.md#{subject_of(one).lower().replace(' ', '-')}): {subject_of(one).lower()}."
            + (f" Also {others}." if others else "")
            + (f" Comes from {_reason(one)}." if one.is_result else ""),
            f"\n```{{eval-rst}}\n{_directive(one)}```\n",
        ]
    )


def _directive(one: PublicName) -> str:
    if one.last == "STYLE":
        return STYLE_PAGE
    if not one.is_class:
        return (
            f".. autofunction:: {one.name}\n" if callable(one.value) else f".. autodata:: {one.name}\n   :no-value:\n"
        )
    options = "   :show-inheritance:\n" if issubclass(one.value, Exception) else ""
    members = f"   :members: {', '.join(one.members)}\n" if one.members else ""
    return f".. autoclass:: {one.name}\n{options}{members}"


def write_reference(folder: Path) -> None:
    """Write the pages of all public objects into a folder."""
    for page, one in page_names().items():
        (folder / f"{page}.md").write_text(object_page(one), encoding="utf-8")
