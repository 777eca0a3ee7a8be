"""``python -m structure.form``: every place that breaks a rule of form, as file:line: what; remedy. Exit code 1 if any.

``make lint`` and ``make precheck`` run it. Rules on modules stand in rules.py, those on the public interface in
public.py, those on texts of reports in words.py.
"""

from __future__ import annotations

import gc
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

from structure.modules import modules_below
from structure.rules import Fault, faults_of_theory, imports_of_tests, package_faults

ROOT = Path(__file__).parents[2]


def form_faults() -> Iterator[Fault]:
    """Faults of all rules of form in the checkout; generated files are looked at by another process meanwhile."""
    command = [sys.executable, ROOT / "docs" / "made_files.py", "--check"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as made_files:
        modules = modules_below(ROOT / "torsionnet")
        yield from package_faults(modules)
        yield from faults_of_theory(ROOT / "docs", modules)
        for folder in ("tests", "docs", "benchmarks"):
            for path in sorted((ROOT / folder).rglob("*.py")):
                yield from imports_of_tests(path)
        yield from faults_of_elements()
        from structure.kinds import kinds_faults
        from structure.public import interface_faults  # loads the package, which may have faults that are told above
        from structure.words import words_faults

        yield from words_faults(ROOT, modules)
        yield from interface_faults()
        yield from kinds_faults(modules)
        told, _ = made_files.communicate()
    for place in told.split():
        yield Fault(place, "is not what the code makes", "make generate")
    if made_files.returncode and not told:
        yield Fault("docs/made_files.py", "the generated files cannot be made", "see the error above; make generate")


def faults_of_elements() -> Iterator[Fault]:
    """Element types in a file of another name, so that every file would be imported to find them, or without example."""
    from support.models import EVERY_ELEMENT

    from torsionnet.model import elements

    for kind, cls in elements.ELEMENT_TYPES.items():
        stem = cls.__module__.rpartition(".")[2]
        if stem != elements.ELEMENT_TYPES.families.get(kind, kind):
            place = f"{cls.__module__.replace('.', '/')}.py:1"
            remedy = f"rename the file to {kind}.py, or list {kind} in ELEMENT_TYPES under its file"
            yield Fault(place, f"has the element type {kind}", remedy)
        if kind not in EVERY_ELEMENT:
            what = f"no example of {kind} in EVERY_ELEMENT"
            yield Fault("tests/support/models.py", what, f'add "{kind}": tn.{cls.__name__}("e", ...)')


def main() -> int:
    gc.disable()  # collecting doubles the time, as all modules are parsed
    count = 0
    for fault in form_faults():
        print(fault, flush=True)
        count += 1
    print(f"form: {count} faults" if count else "form: no faults")
    return int(count > 0)


if __name__ == "__main__":
    sys.exit(main())
