"""Measured orders behind the sliders of the explore page: what the page gets, and what it draws."""

import numpy as np
import pytest
from support import running_fan
from support.explore_pages import WIDE, kept_quiet, serving, visit

import torsionnet as tn
from torsionnet.app.explore import open_session
from torsionnet.app.explore.answers import answer
from torsionnet.app.explore.state import State

DRAWN = "() => torsionnet.drawn().map(({ name, kind, x, magnitude }) => ({ name, kind, x, magnitude }))"


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    path = tmp_path_factory.mktemp("tested")
    running_fan.write(path)
    lines = ["speed [rpm],order,amplitude [N*m],half_width [N*m]"]
    for order in (2, 3):  # of the fan: 0.8 and 1.2 per revolution of the motor
        sizes = [(rpm, running_fan.shaft_torque(rpm, order)) for rpm in np.arange(310.0, 1490.0, 20.0)]
        lines += [f"{rpm},{order / 2.5},{size},{0.02 * size + 0.05}" for rpm, size in sizes]
    (path / "test.csv").write_text("\n".join(lines))
    return path


def test_measured_orders_are_drawn_with_their_own_calculated_curves(folder):
    session = open_session(folder / "fan.json", over_speed=["T"], measured=folder / "test.csv")
    found = answer(session, session.start)["orders"]
    assert [one["name"] for one in found["orders"]] == [one["name"] for one in found["tested"]]
    assert {one["name"] for one in found["tested"]} == {"order 0.8", "order 1.2"}
    two = next(one for one in found["tested"] if one["name"] == "order 0.8")
    assert two["magnitude"] == pytest.approx(running_fan.shaft_torque(np.array(two["rpm"]), 2), rel=1e-9)
    assert two["verdict"].startswith("agrees")
    stiffer = answer(session, State(values={"k": "14 kN*m/rad"}, output="T", axis="speed"))["orders"]
    assert next(one for one in stiffer["tested"] if one["name"] == "order 0.8")["verdict"].startswith("peak at another")


def test_a_file_needs_an_output_over_speed(folder):
    with pytest.raises(tn.UsageError, match="missing-entry"):
        open_session(folder / "fan.json", measured=folder / "test.csv")


def test_the_page_draws_dots_and_intervals(chromium, folder):
    with (
        serving(folder / "fan.json", over_speed=["T"], measured=folder / "test.csv") as server,
        visit(chromium, server.address, viewport=WIDE) as found,
    ):
        found.settle()
        drawn = found.page.evaluate(DRAWN)
        dots = {one["name"]: one for one in drawn if one["kind"] == "dots"}
        assert set(dots) == {"order 0.8, test", "order 1.2, test"}
        assert dots["order 0.8, test"]["magnitude"] == pytest.approx(
            running_fan.shaft_torque(np.array(dots["order 0.8, test"]["x"]), 2), rel=1e-9
        )
        assert "order 0.8 agrees" in found.text("#notes")
        assert kept_quiet(found, server)
