"""Lines of the verification manual on responses to orders and harmonics, from the data of the tests."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator
from typing import Any

import numpy as np
from verification_lines import Line

from support.forced_plants import plant, reference  # isort: skip
from validation.build import build, damper_matrix, read_case, spring_name  # isort: skip

CONDITIONS = {
    "normal": ("normal firing", lambda data: data["normal"]),
    "motored": ("cylinders follow the compression trace", lambda data: data["misfire"]["motored"]),
    "gas_off": ("cylinders without gas", lambda data: data["misfire"]["gas_off"]),
}
"""Conditions of the plants with orders, as the configurations of the tests name them."""


def half_ranges(name: str) -> Iterator[tuple[str, list[Line]]]:
    """Condition and lines of a plant: the half range of each shaft at each speed, then the worst single order."""
    data = reference(name)
    stiffness = {spring["name"]: spring["stiffness"] for spring in data["model"]["springs"]}
    rig = plant(data)
    for configuration, (words, cases_of) in CONDITIONS.items():
        cases = cases_of(data)
        shafts, nodes = list(cases[0]["torque"]), list(cases[0]["angle"])
        outputs = [f"twist({shaft})" for shaft in shafts] + [f"angle({node})" for node in nodes]
        run = rig.configured(configuration).order_response(outputs)
        lines = []
        for at, case in enumerate(cases):
            for place, shaft in enumerate(shafts):
                if shaft in case["half_range"]:
                    found = float(run.half_range[at, place] * stiffness[shaft])
                    label = f"half range of {shaft}, {case['rpm']:g} r/min"
                    allowed = data["tolerance"]["half_range_rel"]
                    lines.append(Line(label, "N m", case["half_range"][shaft], found, allowed, "dense solve"))
        yield words, [*lines, *single_orders(run, cases, stiffness, data["tolerance"]["computed_rel"])]


def single_orders(run: Any, cases: list[dict[str, Any]], stiffness: dict[str, float], allowed: float) -> list[Line]:
    """Lines of every order of every shaft torque and angle, complex amplitudes."""
    lines = []
    for at, case in enumerate(cases):
        asked = [(f"twist({shaft})", stiffness[shaft], orders) for shaft, orders in case["torque"].items()]
        asked += [(f"angle({node})", 1.0, orders) for node, orders in case["angle"].items()]
        for output, factor, orders in asked:
            for key, parts in orders.items():
                excitation, _, order = key.rpartition(" ")
                found = factor * run.of_order(float(order), output, excitation or "engine")[at]
                unit = "N m" if output.startswith("twist") else "rad"
                label = f"order {key} of {output} at {case['rpm']:g} r/min"
                lines.append(Line(label, unit, complex(*parts), complex(found), allowed, "dense solve"))
    return lines


def chain_of_five() -> list[Line]:
    """Lines of the chain of five discs under four harmonics: angles of discs and torques of shafts."""
    case = read_case("forced_ot_docs_chain5")
    base = read_case(case["model"])
    model, allowed = build(base), case["tolerance"]["computed_rel"]
    frequencies = np.array(case["omega_rad_s"]) / (2 * math.pi)
    nodes = [node["name"] for node in base["nodes"]]
    shafts = [spring_name(spring) for spring in base["springs"]]
    described = re.search(r"harmonic torques ([\d,.]+) N m", case["description"])
    assert described is not None
    harmonics = [float(text) for text in described[1].split(",")]
    lines = []
    for outputs, unit, references, sign in (
        (nodes, "rad", case["response_rad"], 1),
        ([f"torque({shaft})" for shaft in shafts], "N m", case["shaft_torque_Nm"], -1),
    ):
        found = model.frequency_response(outputs, "n0", frequencies).values[:, :, 0]
        for place, output in enumerate(outputs):
            for at, (reference_value, amplitude) in enumerate(zip(references[place], harmonics, strict=True)):
                label = f"{output}, harmonic {at + 1}"
                value = sign * amplitude * complex(found[at, place])
                lines.append(Line(label, unit, reference_value, value, allowed, "openTorsion"))
    return lines


def wind_turbine() -> list[Line]:
    """Lines of the wind turbine: sum of the harmonics of each shaft's torque, and the speeds of two peaks."""
    case = read_case("forced_sopanen_windmill")
    base = read_case(case["model"])
    nodes = [node["name"] for node in base["nodes"]]
    model = build(base, damper_matrix(nodes, case["damping_matrix_C"]))
    shafts = [spring_name(spring) for spring in base["springs"]]
    outputs = [f"torque({shaft})" for shaft in shafts]

    def torques(omega: Any) -> Any:
        at = np.asarray(omega) / (2 * np.pi)
        return model.frequency_response(outputs, case["excitation"]["node"], at).magnitude[:, :, 0].T

    lines = []
    for point in case["reference_from_openTorsion_0.3.2"]:
        found = (torques(point["omega_rad_s"]) * np.array(point["amplitude_Nm"])).sum(axis=1)
        for shaft, value, wanted in zip(shafts, found.tolist(), point["vibratory_torque_sum_Nm"], strict=True):
            label, allowed = f"torque of {shaft} at {point['rpm']:g} r/min", case["tolerance"]["computed_rel"]
            lines.append(Line(label, "N m", wanted, value, allowed, "openTorsion 0.3.2"))
    peaks = case["published_resonances_rpm"]
    for rpm, shaft in ((rpm, shaft) for rpm in peaks["values"] for shaft in range(len(shafts))):
        near = np.linspace(0.8 * rpm, 1.2 * rpm, 801)
        found = float(near[np.argmax(torques(12 * 2 * np.pi * near)[shaft])])
        label = f"peak of the twelfth harmonic in {shafts[shaft]}"
        lines.append(Line(label, "r/min", rpm, found, peaks["tolerance"], "graph", absolute=True))
    return lines
