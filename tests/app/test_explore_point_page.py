"""Sliders of the operating point on the explore page in headless Chromium; skipped, with a reason, without one."""

import re

import numpy as np
import pytest
from support.explore_pages import WIDE, drawn, kept_quiet, serving, slider, visit
from support.explore_texts import CRANK, GEARS, LINE, RATIO, WHEEL

import torsionnet as tn


@pytest.fixture(scope="module")
def path(tmp_path_factory):
    found = tmp_path_factory.mktemp("line") / "line.yaml"
    found.write_text(LINE + GEARS.replace("wheel: -400", "box: 0, wheel: -400"))
    return found


@pytest.fixture(scope="module")
def served(path):
    with serving(path) as server:
        yield server


@pytest.fixture
def opened(chromium, served):
    with visit(chromium, served.address, viewport=WIDE) as found:
        yield found
        assert kept_quiet(found, served)


def field(found, name):
    return found.page.locator(f"[id='parameter-{name}']")


def check(found, path, torque):
    """The curve is that of the library at the operating point."""
    curve = drawn(found)[0]
    rig = tn.load(path).at(torque={"crank": torque, "wheel": -RATIO * torque})
    expected = rig.frequency_response("crank", "crank", np.array(curve["frequencies"])).magnitude[:, 0, 0]
    np.testing.assert_allclose(curve["magnitude"], expected, rtol=1e-9)


@pytest.mark.slow
def test_curve_modes_and_the_other_torque_follow_a_slider(opened, path):
    check(opened, path, 20)
    assert opened.page.locator(".parameter:visible .name").all_inner_texts()[:2] == [
        "torque on crank",
        "torque on wheel",
    ]
    assert field(opened, "operating_point.torque.box").is_hidden()
    crank = slider(opened, "torque on crank")
    crank.focus()
    before = opened.text("#modes")
    for _ in range(2):
        with opened.update():
            opened.page.keyboard.press("PageDown")
    with opened.update():
        opened.page.keyboard.press("End")
    torque = float(field(opened, CRANK).input_value())
    assert torque == 40
    assert float(field(opened, WHEEL).input_value()) == -RATIO * torque
    assert opened.page.locator(".derived:visible").all_inner_texts() == ["follows, in balance"]
    check(opened, path, torque)
    with opened.update():
        field(opened, CRANK).fill("60 N*m")
        opened.page.keyboard.press("Enter")
    check(opened, path, 60)
    assert opened.text("#modes") != before
    assert "--set 'operating_point.torque.wheel=-240 N*m'" in opened.text("#command")
    opened.page.click("#pin")
    opened.until(lambda: opened.page.locator(".pin-name").count() == 1, "the pin")
    assert opened.page.locator(".pin-name").input_value() == "torque on crank = 60 N·m"
    with opened.update():
        opened.page.click("#reset")
    check(opened, path, 20)


@pytest.mark.slow
def test_without_balance_the_message_stands_there_and_the_last_curve_is_faint(opened, path):
    for name, text in ((CRANK, "60"), (WHEEL, "-100")):
        field(opened, name).fill(text)
        opened.page.keyboard.press("Enter")
        opened.settle()
    opened.until(lambda: opened.page.is_visible("#refused"), "the message")
    assert re.search(r"crank 60 N\*m, wheel -100 N\*m\) leave 35 N\*m over", opened.text("#refused"))
    assert field(opened, WHEEL).get_attribute("aria-invalid") is not None
    with opened.update():
        opened.page.get_by_role("button", name="Reset torque on wheel").click()
    assert opened.page.is_hidden("#refused")
    assert float(field(opened, WHEEL).input_value()) == -240
    check(opened, path, 60)


@pytest.mark.slow
def test_a_configuration_shows_its_torques_and_the_address_keeps_the_point(opened, path):
    with opened.update():
        opened.page.get_by_role("tab", name="low").click()
    assert field(opened, "operating_point.torque.box").is_visible()
    check(opened, path, 100)
    with opened.update():
        field(opened, CRANK).fill("30")
        opened.page.keyboard.press("Enter")
    opened.until(lambda: "torque.crank" in opened.page.evaluate("location.hash"), "the address")
    opened.page.reload()
    opened.until(lambda: opened.updates, "the page again")
    opened.settle()
    check(opened, path, 30)


@pytest.mark.slow
def test_a_page_that_begins_out_of_balance(chromium, tmp_path):
    path = tmp_path / "line.yaml"
    path.write_text(LINE.replace("-80", "-8"))
    with serving(path) as server, chromium.new() as page:
        page.goto(server.address)
        page.wait_for_selector("#refused:visible")
        assert "leave 18 N*m over" in page.inner_text("#refused")
        assert page.locator(f"[id='parameter-{WHEEL}']").input_value() == "-8"
        page.locator(f"[id='parameter-{CRANK}']").fill("2")
        page.keyboard.press("Enter")
        page.wait_for_selector("#refused", state="hidden")
        page.wait_for_selector("#modes tbody tr")
