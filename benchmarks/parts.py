"""CPU times to load and to solve a plant of 400 elements built with parts, against its flat file.

Median over runs, both in one process; the flat file is what ``torsionnet show --flat`` prints.
"""

import statistics
import tempfile
import time
from pathlib import Path

import numpy as np

import torsionnet as tn
from benchmarks._sizes import sized
from torsionnet.model.files.writer import flat_text

RUNS = sized(7, 1)
LINES = sized(16, 2)
BUDGET = 0.5
FREQUENCIES = np.linspace(1, 200, sized(1000, 20))

PLANT = """\
torsionnet: 1
name: engines on one shaft
parts:
  throw:
    ports: [front, rear]
    parameters: {J: 50 kg*m^2, k: 36 MN*m/rad}
    elements:
      mass: {type: inertia, node: front, inertia: J}
      shaft: {type: spring, nodes: [front, rear], stiffness: k, damping: {zeta: 0.005, at: 60 Hz}}
  engine:
    ports: [out]
    parameters: {J: 50 kg*m^2, k_c: 0.3 MN*m/rad}
    elements:
      flywheel: {type: inertia, node: fly, inertia: 800 kg*m^2}
      coupling: {type: spring, nodes: [fly, pinion], stiffness: k_c, damping: 900}
      pinion: {type: inertia, node: pinion, inertia: 14 kg*m^2}
      mesh: {type: gear, nodes: [pinion, out], ratio: -4.9}
      damper: {type: viscous_damper, node: nose, ring_inertia: 100, damping: 40 kN*m*s/rad}
    use: {cyl: {part: throw, repeat: 10, chain: [front, rear], at: {front: nose, rear: fly}, parameters: {J: J}}}
elements:
  wheel: {type: inertia, node: wheel, inertia: 640 kg*m^2}
use: {line: {part: engine, repeat: LINES, at: {out: wheel}}}
inputs: {T: {torque: line1.nose}}
"""


def cpu(work):
    found = []
    for _ in range(RUNS):
        start = time.process_time()
        work()
        found.append(time.process_time() - start)
    return statistics.median(found)


def main():
    with tempfile.TemporaryDirectory() as folder:
        parts, flat = Path(folder, "parts.yaml"), Path(folder, "flat.yaml")
        parts.write_text(PLANT.replace("LINES", str(LINES)), encoding="utf-8")
        flat.write_text(flat_text(tn.load(parts).definition), encoding="utf-8")
        loading = [cpu(lambda path=path: tn.load(path)) for path in (parts, flat)]
        solving = [
            cpu(lambda path=path: tn.load(path).frequency_response("wheel", "T", FREQUENCIES)) - seconds
            for path, seconds in zip((parts, flat), loading, strict=True)
        ]
        modes = [
            cpu(lambda path=path: tn.load(path).modes()) - seconds
            for path, seconds in zip((parts, flat), loading, strict=True)
        ]
        count = len(tn.load(parts).elements)
    print(f"{count} elements")
    print("| | with parts, CPU s | flat, CPU s |")
    print("|---|---|---|")
    print(f"| load (budget {BUDGET:g}) | {loading[0]:.3f} | {loading[1]:.3f} |")
    print(f"| {len(FREQUENCIES)} frequencies | {solving[0]:.3f} | {solving[1]:.3f} |")
    print(f"| modes | {modes[0]:.3f} | {modes[1]:.3f} |")


if __name__ == "__main__":
    main()
