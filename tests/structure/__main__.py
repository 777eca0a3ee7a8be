"""``python -m structure [COMMIT ...]``: the counts of commits beside those of the checkout, as a Markdown table."""

from __future__ import annotations

import io
import subprocess
import sys
import tarfile
import tempfile
from pathlib import Path

from structure.core_use import use_measures
from structure.measures import circles, doubled_classes, measures
from structure.modules import modules_below

ROOT = Path(__file__).parents[2]


def of_commit(commit: str) -> dict[str, str]:
    """Counts of the package in a commit, and what calls of it load and pass."""
    packed = subprocess.run(
        ["git", "archive", commit, "torsionnet", "library"], cwd=ROOT, check=True, capture_output=True
    ).stdout
    with tempfile.TemporaryDirectory() as folder:
        with tarfile.open(fileobj=io.BytesIO(packed)) as archive:
            archive.extractall(folder, filter="data")
        return measures(Path(folder) / "torsionnet") | use_measures(Path(folder))


def main(commits: list[str]) -> None:
    columns = {commit: of_commit(commit) for commit in commits} | {
        "now": measures(ROOT / "torsionnet") | use_measures(ROOT)
    }
    print(f"| | {' | '.join(columns)} |\n|---|{'---|' * len(columns)}")
    for name in columns["now"]:
        print(f"| {name} | {' | '.join(column[name] for column in columns.values())} |")
    modules = modules_below(ROOT / "torsionnet")
    for title, found in (
        ("in a circle", [", ".join(part) for part in circles(modules)]),
        ("class names twice", doubled_classes(modules)),
    ):
        print(f"\n{title}: {'; '.join(found) or 'none'}")


if __name__ == "__main__":
    main(sys.argv[1:])
