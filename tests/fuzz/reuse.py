"""Models of parts, components, catalogues and makers' sheets, and files that they name."""

from __future__ import annotations

from functools import cache
from pathlib import Path

from fuzz.mutating import Chance, mutated

TESTS = Path(__file__).parents[1]
THROW = """\
torsionnet: 1
name: throw
ports: [front, rear]
parameters: {J: 61 kg*m^2, k: 38 MN*m/rad}
elements:
  mass: {type: inertia, node: front, inertia: J}
  shaft: {type: spring, nodes: [front, rear], stiffness: k}
sensors: {T: {torque: shaft}}
configurations: {soft: {}, hard: {k: 50 MN*m/rad}}
"""
TWIN = """\
torsionnet: 1
name: two throws from a file, and more
include: [throw.yaml]
parts:
  pair:
    ports: [a, b]
    parameters: {k: 30 MN*m/rad}
    use: {in_it: {part: throw, repeat: 2, chain: [front, rear], at: {front: a, rear: b}, parameters: {k: [k, 2*k]}}}
parameters: {k_1: 20 MN*m/rad}
elements:
  flywheel: {type: inertia, node: fly, inertia: 780 kg*m^2}
  box: {type: gearbox, input: fly, output: out, ratios: {I: -4, II: 2}, engaged: II, wheel_inertias: {I: 0.4, II: 0.2}}
  pump: {type: inertia, node: out, inertia: 3, referred_to: fly}
  rubber: {type: flexible_coupling, nodes: [out, load], catalogue: couplings.csv, size: A350}
  load: {type: inertia, node: load, inertia: 9}
use:
  cyl: {part: pair, repeat: 2, chain: [a, b], at: {a: c1, b: fly}, parameters: {k: [k_1, 31 MN*m/rad]}}
  rig: {part: half_shaft, at: {inner: out, road: road}}
inputs: {T: {torque: [c1, fly]}, phi: {angle: [out, load]}}
sensors: {T_1: {torque: cyl1.in_it2.shaft}, rel: {velocity: [fly, load], referred_to: out}}
configurations: {box: {I: {box.engaged: I}, other: {rubber.size: B1.000, cyl2.k: 9 MN*m/rad}}}
"""
GOVERNOR = "{type: controller, sense: {velocity: [fly, load]}, act: fly, law: {p: -40, i: -90}, delay: 3 ms}"
RUBBER = "{type: flexible_coupling, nodes: [out, load], catalogue: couplings.csv, size: A350}"
GOVERNED = (
    TWIN.replace(RUBBER, "{type: spring, nodes: [out, load], stiffness: 11 kN*m/rad}\n  governor: " + GOVERNOR)
    .replace("rubber.size: B1.000", "rubber.stiffness: 9 kN*m/rad")
)  # fmt: skip
COUPLINGS = """\
# made-up couplings
size;stiffness [kN*m/rad];loss_factor.psi;T_KN [kN*m];T_KW [kN*m];P_KV [W];description
A350;11,2;0,78;3,5;0,88;260;rubber
B1.000;34;1,0;10;3,0;450;soft
"""
SIZED = """\
torsionnet: 1
name: two masses
elements:
  motor: {type: inertia, node: a, inertia: 2}
  load: {type: inertia, node: b, inertia: 3}
  coupling: {type: hysteretic_spring, nodes: [a, b], catalogue: input.csv, size: A350}
inputs: {T: {torque: a}}
sensors: {phi: {angle: b}}
"""
SHEET = """\
torsionnet: 1
name: sheet
elements:
  engine: {type: mass_elastic, table: input.csv}
"""


def furnish(folder: Path) -> None:
    (folder / "throw.yaml").write_text(THROW)
    (folder / "couplings.csv").write_text(COUPLINGS)


@cache
def plants() -> tuple[str, ...]:
    written = (path.read_text(encoding="utf-8") for path in sorted((TESTS / "parts").glob("*.yaml")))
    return (TWIN, GOVERNED, *written)


@cache
def sheets() -> tuple[str, ...]:
    return tuple(path.read_text(encoding="utf-8") for path in sorted((TESTS / "sheets").glob("*.csv")))


def component_plant(chance: Chance) -> str:
    """All components and parts, in the blocks of a JSON document."""
    from plain.trains import plant

    text = plant(str(chance.random())).text
    return mutated(text, chance) if chance.random() < 0.8 else text
