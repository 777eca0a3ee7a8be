"""``python -m structure.outputs record FOLDER``: record the output of every command for every library model.

For changes that move code: what a user gets before the first move and after each must be equal, byte for byte. What a
command prints goes into one file with its exit code and the files it wrote, by their contents.
"""

from __future__ import annotations

import difflib
import hashlib
import os
import re
import subprocess
import sys
import tempfile
import zipfile
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import torsionnet as tn

Call = tuple[str, ...]
OF_EVERY_MODEL = {
    "check": "check MODEL",
    "show": "show MODEL --plot schematic.svg --matrices",
    "equations": "equations MODEL",
    "modes": "modes MODEL -c all --plot modes.png --csv modes.csv",
    "modes-json": "modes MODEL --json",
    "margins": "margins MODEL --plot margins.png",
    "sensitivity": "sensitivity MODEL --csv sensitivity.csv",
    "frf": "frf MODEL --output SENSOR --input INPUT --plot frf.png --csv frf.csv",
    "orders": "orders MODEL --output SENSOR --plot orders.png --csv orders.csv",
    "critical-speeds": "critical-speeds MODEL --plot campbell.png --csv critical.csv",
    "holzer": "holzer MODEL --mode 1",
    "static": "static MODEL --csv static.csv",
    "limits": "limits MODEL --plot limits.png --json",
    "report": "report MODEL -o report.html",
    "report-latex": "report MODEL -o report.tex",
    "tors": "export MODEL -o model.tors",
    "matlab": "export MODEL -o model.m",
    "modelica": "export MODEL -o model.mo",
    "sheet": "export MODEL -o sheet.csv",
    "fmu": "export MODEL -o model.fmu",
}
ONCE = {
    "library": ["library"],
    "schema": ["schema -o model.json", "schema --kind study -o study.json"],
    "study": ["study amt_tolerances --plot tolerances.png -o results"],
    "damper": ["damper marine_medium_speed --vary c_dmp --output T_cpl --plot film.png"],
    "record": [
        "bench amt_bench -c V -o V.npz",
        "estimate V.npz --input T_T --output theta_1 --preset paper --angle-unit deg --plot frf.png --csv frf.csv",
        "compare V.npz amt_rig -c V --output theta_1 --input T_T --preset paper --band 0 40 --plot compared.png",
        "spectrogram V.npz --channel T_T --decimate 50 --plot torque.png",
        "identify-modes V.npz --output theta_1 --input T_T --preset paper --model amt_rig -c V",
        "report amt_rig -c V --record V.npz --output theta_1 --input T_T --seconds 4 --record-band 0.5 40 -o test.html",
    ],
    "fit": ["bench dmf_bench --seed 7 -o test.npz", "fit fit.yaml --plot fit.png -o result.yaml"],
    "wrong": ["check wrong.yaml", "modes amt_rgi", "frf amt_rig --output theta_9", "limits amt_rig"],
}
FILES = {
    "fit.yaml": """model: dmf_rig
measurements:
  - {record: test.npz, output: theta_1, input: T_T, band: [2 Hz, 60 Hz]}
parameters: {c_1: {}}
""",
    "wrong.yaml": "torsionnet: 1\nname: wrong\nelements: {k: {type: sprin, nodes: [a], stiffness: -5 N*m}, x: 1}\n",
}
CHANGES = [
    (re.compile(r"\b\d+(\.\d+)? (ms|s|min)\b(?= (of|for|per|with|in)\b)"), "# s"),
    (re.compile(r'guid="[^"]*"|generationDateAndTime="[^"]*"|instantiationToken="[^"]*"'), ""),
    (re.compile(r"\b20\d\d-\d\d-\d\d([T ]\d\d:\d\d(:\d\d)?(\.\d+)?Z?)?"), "DATE"),
]
"""What differs between two runs of the same code: times taken, dates, identities of an FMU."""


def calls() -> Iterator[tuple[str, list[Call]]]:
    """Names of groups of calls, and their commands, which run one after the other in one folder."""
    for name in sorted(path.stem for path in (Path(tn.__file__).parents[1] / "library").glob("*.yaml")):
        definition = tn.load(name).definition
        words = {
            "MODEL": name,
            "SENSOR": next(iter(definition.sensors), ""),
            "INPUT": next(iter(definition.inputs), ""),
        }
        for kind, line in OF_EVERY_MODEL.items():
            yield f"{name}.{kind}", [tuple(words.get(word, word) for word in line.split())]
    for kind, lines in ONCE.items():
        yield kind, [tuple(line.split()) for line in lines]


def run(commands: list[Call]) -> str:
    """Texts that commands print, with exit codes, and the contents of the files they write."""
    environment = os.environ | {"NO_COLOR": "1", "COLUMNS": "120", "SOURCE_DATE_EPOCH": "0"}
    with tempfile.TemporaryDirectory() as folder:
        for name, text in FILES.items():
            (Path(folder) / name).write_text(text, encoding="utf-8")
        said = []
        for command in commands:
            argv = [sys.executable, "-m", "torsionnet", *command]
            done = subprocess.run(argv, cwd=folder, env=environment, capture_output=True, text=True, check=False)
            said.append(f"$ {' '.join(command)}\n{done.stdout}\n-- {done.returncode}\n{done.stderr}")
        files = sorted(path for path in Path(folder).rglob("*") if path.is_file() and path.name not in FILES)
        said += [f"{path.relative_to(folder).as_posix()}: {_contents(path)}" for path in files]
        text = "\n".join(said).replace(folder, "FOLDER")
    for pattern, instead in CHANGES:
        text = pattern.sub(instead, text)
    return text


def _contents(path: Path) -> str:
    """Text of a file; members of an archive; digest of other files."""
    if zipfile.is_zipfile(path):
        with zipfile.ZipFile(path) as archive:
            texts = [name for name in archive.namelist() if name.endswith((".xml", ".c", ".h"))]
            return "\n".join([*archive.namelist(), *(archive.read(name).decode() for name in texts)])
    data = path.read_bytes()
    if path.suffix in {".csv", ".json", ".m", ".mo", ".tors", ".yaml", ".tex", ".html", ".md", ".svg"}:
        return "\n" + data.decode("utf-8")
    return hashlib.sha256(data).hexdigest()


def record(folder: Path) -> None:
    """Run all commands, two groups at a time, and write a text file for each group."""
    folder.mkdir(parents=True, exist_ok=True)
    with ThreadPoolExecutor(2) as pool:
        pieces = [(name, pool.submit(run, commands)) for name, commands in calls()]
        for name, done in pieces:
            (folder / f"{name}.txt").write_text(done.result(), encoding="utf-8")
            print(name, flush=True)


def same(before: Path, after: Path) -> bool:
    """Whether two folders hold equal outputs; the first lines of differences are printed."""
    equal = True
    for name in sorted({path.name for folder in (before, after) for path in folder.glob("*.txt")}):
        texts = [(folder / name).read_text("utf-8") if (folder / name).exists() else "" for folder in (before, after)]
        if texts[0] != texts[1]:
            equal = False
            lines = difflib.unified_diff(*(text.splitlines() for text in texts), "before", "after", lineterm="", n=0)
            print(f"== {name}", *(line[:200] for _, line in zip(range(12), lines, strict=False)), sep="\n")
    print("equal" if equal else "not equal")
    return equal


if __name__ == "__main__":
    match sys.argv[1:]:
        case ["record", folder]:
            record(Path(folder))
        case ["same", before, after]:
            sys.exit(not same(Path(before), Path(after)))
        case _:
            sys.exit(__doc__)
