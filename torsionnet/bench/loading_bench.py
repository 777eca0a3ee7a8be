"""Test benches read from a model file with a ``bench:`` section, or from a bench file that names the model."""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

from torsionnet.base.entries.declared import version_faults
from torsionnet.base.errors import Fault, ModelError, TorsionnetError, UsageError, did_you_mean, fault_of
from torsionnet.bench.bench import Bench
from torsionnet.bench.plan.bench_checks import check_plan
from torsionnet.bench.plan.plan import BenchFile
from torsionnet.drivetrain import Drivetrain, load
from torsionnet.model.files.fault_places import located_faults, read_document
from torsionnet.model.files.library import library_benches
from torsionnet.model.files.located_yaml import LocatedDocument
from torsionnet.model.files.reader import find_model, read_file


def load_bench(bench: str | os.PathLike[str]) -> Bench:
    """Load the test bench of a file, or a bench of the library by name.

    Parameters
    ----------
    bench : str or path
        A model file with a ``bench:`` section; a file with ``model:`` (a library model, or a path from this file),
        perhaps ``configuration:``, and ``bench:``; or a name out of :func:`library_benches`.

    Raises
    ------
    ModelError
        With every fault of the file and its place.
    UsageError
        There is no such file or bench.

    Examples
    --------
    >>> bench = load_bench("amt_bench")
    >>> bench.drivetrain.title, bench.plan.channels["theta_1"].steps
    ('AMT test rig (II)', 1024)
    """
    path = _find(bench)
    document = read_document(path)
    if isinstance(document.data, dict) and "model" in document.data and "elements" not in document.data:
        return _of_its_own(document, path)
    definition, faults = read_file(path)
    if definition is None:
        raise ModelError([fault for fault in faults if fault.severity == "error"], path.name)
    if definition.bench is None:
        raise UsageError(
            f"{path.name} describes no test bench: add bench:, or take one of {', '.join(library_benches())}",
            kind="missing-entry",
        )
    return Bench(Drivetrain.from_definition(definition, faults), definition.bench)


def _find(bench: str | os.PathLike[str]) -> Path:
    known = library_benches()
    if isinstance(bench, str):
        if bench in known:
            return known[bench]
        if not Path(bench).suffix and not Path(bench).exists() and (hint := did_you_mean(bench, known)):
            raise UsageError(f'no bench is named "{bench}"{hint}', kind="unknown-name")
    return find_model(bench)


def _of_its_own(document: LocatedDocument, path: Path) -> Bench:
    data: Mapping[Any, Any] = document.data
    entries, faults = BenchFile.read_entries(data)
    faults = [*version_faults(data, "bench"), *faults]
    drivetrain, further = _model(entries, path) if "model" in entries else (None, [])
    faults += further
    plan = entries.get("bench")
    if plan is not None and drivetrain is not None:
        faults += check_plan(plan, drivetrain.definition, values=drivetrain.exact_values)
    faults += document.faults
    if faults or plan is None or drivetrain is None:
        raise ModelError(located_faults(faults, document), path.name)
    return Bench(drivetrain, plan)


def _model(entries: Mapping[str, Any], path: Path) -> tuple[Drivetrain | None, list[Fault]]:
    """Drivetrain named in a bench file, in its configuration, and the faults found; no drivetrain if there are any."""
    name = entries["model"]
    if name is None:
        return None, []
    try:
        drivetrain = load(path.parent / name if Path(name).suffix else name)
    except UsageError as error:
        return None, [replace(error.fault, path=("model",))]
    except ModelError as error:
        return None, [Fault(f"{name} has {len(error.faults)} errors", ("model",), kind=error.kind), *error.faults]
    configuration = entries.get("configuration")
    if configuration is None:
        return drivetrain, []
    try:
        return drivetrain.configured(configuration), []
    except TorsionnetError as error:
        return None, [replace(fault_of(error, error.kind), path=("configuration",))]
