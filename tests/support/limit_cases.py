"""Verdicts of limits on responses made for the purpose."""

import math
from fractions import Fraction

import numpy as np

import torsionnet as tn
from torsionnet.linear.frequency_response import Channel
from torsionnet.machinery.checks.section_checks import limit_subject
from torsionnet.machinery.limits.evidence import Evidence
from torsionnet.machinery.orders.order_response import OrderLine, OrderResponse
from torsionnet.machinery.orders.worst_response import WorstResponse
from torsionnet.model.channels import Sensor
from torsionnet.model.elements.shaft import Shaft

RPM = math.pi / 30
STEEL = {"material": "alloy", "tensile_strength": "600 MPa"}


def m68(**more):
    return {
        "rule": "iacs_m68",
        "element": "shaft",
        "shaft": "intermediate",
        "feature": "integral_flange",
        **STEEL,
        **more,
    }


def stressed(stress, limit, rpm=None, diameter=0.4, misfire=False, rated=100.0, cases=None):
    """Verdicts on a shaft whose stress over speed is given, in N/mm^2, with one order."""
    rpm = np.arange(20.0, 104.01, 0.5) if rpm is None else rpm
    elements = [tn.Inertia("J", node="a", inertia=1), tn.Inertia("K", node="b", inertia=1),
                Shaft("shaft", nodes=("a", "b"), outer_diameter=diameter, length=1)]  # fmt: skip
    engine = {"type": "reciprocating_engine", "speed_of": "a", "cycle": 2, "cylinders": {1: "a", 2: "a"},
              "firing_order": [1, 2], "bore": 0.1, "stroke": 0.1, "rod_length": 0.2,
              **({"gas_off": [2]} if misfire else {})}  # fmt: skip
    rig = tn.Drivetrain("rig", elements, speeds={"of": "a", "list": (rpm * RPM).tolist(), "rated": f"{rated} rpm"},
                        excitations={"engine": engine}, limits={"shaft": limit})  # fmt: skip
    torque = np.asarray(stress(rpm)) * 1e6 * math.pi * diameter**3 / 16
    sensors = [Sensor("torque", "shaft", "first"), Sensor("torque", "shaft", "second"),
               Sensor("torque", "shaft"), Sensor("twist", "shaft")]  # fmt: skip

    def response(torque):
        return OrderResponse(
            rpm * RPM, "a", (OrderLine("engine", 1.0, Fraction(1)),),
            np.stack([torque, 0.9 * torque, torque, torque], axis=1)[:, None, :].astype(complex),
            tuple(Channel(str(one), "N*m") for one in sensors),
        )  # fmt: skip

    run_ = response(torque)
    if cases is not None:
        each = tuple(response(one * 1e6 * math.pi * diameter**3 / 16) for one in cases.T)
        chosen = np.repeat(np.argmax(cases, axis=1)[:, None], len(sensors), axis=1)
        labels = ("one", "two")
        run_ = WorstResponse(
            **vars(run_), labels=labels, chosen=chosen, each=each, largest=abs(run_.values),
            alternatives=dict(zip(labels, each, strict=True)),
        )  # fmt: skip
    evidence = Evidence(run_, {}, "no load", limit_subject(rig.definition, rig.exact_values))
    return {one.criterion: one for one in rig.definition.limits["shaft"].verdicts("shaft", evidence)}


def hump(peak, at, width=2.0, floor=5.0):
    return lambda rpm: floor + (peak - floor) / (1 + ((rpm - at) / width) ** 2)
