"""The plants of ``validation/forced``: drivetrains with engines and propellers, whose responses come from elsewhere."""

import json
from pathlib import Path

import torsionnet as tn

FOLDER = Path(__file__).parents[1] / "validation" / "forced"
NAMES = sorted(path.stem for path in FOLDER.glob("*.json"))


def reference(name):
    return json.loads((FOLDER / f"{name}.json").read_text(encoding="utf-8"))


def plant(data):
    """The drivetrain with its excitations; configurations normal, motored, gas_off."""
    return tn.Drivetrain(
        data["name"],
        [*_inertias(data["model"]), *_springs(data["model"])],
        speeds={"of": data["engine"]["nodes"][0], "list": [f"{case['rpm']} rpm" for case in data["normal"]]},
        excitations={"engine": _engine(data), **_propeller(data)},
        configurations={
            "firing": {
                "normal": {},
                "motored": {"engine.misfire": data["misfire"]["cylinders"]},
                "gas_off": {"engine.gas_off": data["misfire"]["cylinders"]},
            }
        },
    )


def _inertias(model):
    for node in model["nodes"]:
        yield tn.Inertia(f"J_{node['name']}", node=node["name"], inertia=node["inertia"])
        if node.get("damping_to_ground"):
            yield tn.Damper(f"c_{node['name']}", nodes=(node["name"], "ground"), damping=node["damping_to_ground"])


def _springs(model):
    for spring in model["springs"]:
        nodes = (spring["from"], spring["to"])
        if spring.get("loss_factor"):
            yield tn.HystereticSpring(
                spring["name"], nodes=nodes, stiffness=spring["stiffness"], loss_factor=spring["loss_factor"]
            )
        elif spring["stiffness"]:
            yield tn.Spring(
                spring["name"], nodes=nodes, stiffness=spring["stiffness"], damping=spring.get("damping", 0)
            )
        else:
            yield tn.Damper(spring["name"], nodes=nodes, damping=spring["damping"])


def _engine(data):
    engine, pressure = data["engine"], data["engine"]["pressure"]
    gas = {
        "fired": pressure["pressure_Pa"],
        "motored": pressure["pressure_motored_Pa"],
        "crankcase": engine["crankcase_pressure_Pa"],
    }
    by_speed = engine.get("gas_torque_by_speed")
    if by_speed:
        gas |= {"rated": f"{by_speed['rated_rpm']} rpm", "exponent": by_speed["exponent"]}
    dimensions = ("bore", "stroke", "rod_length", "reciprocating_mass", "cycle", "firing_order")
    return {
        "type": "reciprocating_engine",
        "speed_of": engine["nodes"][0],
        "cylinders": dict(enumerate(engine["nodes"], 1)),
        "gas": gas,
        "orders": data["orders"],
        **{name: engine[name] for name in dimensions},
    }


def _propeller(data):
    given = data.get("propeller")
    if not given:
        return {}
    blades = given["orders"][0][0]
    return {
        "propeller": {
            "type": "propeller",
            "node": given["node"],
            "blades": blades,
            "torque": given["rated_torque"],
            "rated": f"{given['rated_rpm']} rpm",
            "blade_orders": {
                order // blades: {"share": share, "phase": f"{phase} deg"} for order, share, phase in given["orders"]
            },
        }
    }
