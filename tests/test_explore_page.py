"""The explore page clicked through in headless Chromium; skipped, with a reason, where there is none."""

import json
import re
import time
from urllib.parse import urlsplit

import numpy as np
import pytest
from explore_pages import browser_or_skip, serving, visit

import torsionnet as tn
from torsionnet.cli import main
from torsionnet.explore.choices import ResponseChoice
from torsionnet.io import write_frequency_response

WIDE = {"width": 1440, "height": 900}
SLOW = 500.0
"""ms; on a quiet machine an update takes 25. A shared one that builds other things meanwhile is no fault of ours."""

DRAWN = """() => {
  const data = globalThis.torsionnet.drawn();
  return data.map(({ kind, frequencies, magnitude, phase }) => ({ kind, frequencies, magnitude, phase }));
}"""


@pytest.fixture(scope="module")
def browser():
    path = browser_or_skip()
    from playwright.sync_api import sync_playwright

    with sync_playwright() as playwright:
        found = playwright.chromium.launch(executable_path=path, args=["--no-sandbox"])
        yield found
        found.close()


@pytest.fixture(scope="module")
def amt(tmp_path_factory):
    """The AMT rig with a test of gear V laid over it."""
    f = np.linspace(0.5, 40, 80)
    path = tmp_path_factory.mktemp("test") / "gear_V.csv"
    write_frequency_response(tn.load("amt_rig").configured("V").frequency_response("theta_1", "T_T", f), path)
    with serving("amt_rig", configuration="V", pairs=[ResponseChoice("theta_1", "T_T")], overlay=path) as server:
        yield server


@pytest.fixture
def opened(browser, amt):
    """The page; afterwards nothing was said on the console and nothing was asked of anyone else."""
    with visit(browser, amt.address, viewport=WIDE) as found:
        found.until(lambda: len(drawn(found)) == 2, "the test")
        yield found
        assert found.console == []
        assert {urlsplit(url).netloc for url in found.requests if not url.startswith(("blob:", "data:"))} == {
            urlsplit(amt.address).netloc
        }


def drawn(found):
    """The curves as they are handed to the plots."""
    return found.page.evaluate(DRAWN)


def slider(found, name):
    return found.page.get_by_role("slider", name=re.compile(rf"^{name}\b"))


def check_curve(curve, configuration, output="theta_1", into="T_T", scale=1.0, **values):
    f = np.array(curve["frequencies"])
    rig = tn.load("amt_rig").configured(configuration, **values)
    expected = rig.frequency_response(output, into, f).magnitude[:, 0, 0]
    np.testing.assert_allclose(curve["magnitude"], scale * expected, rtol=1e-12)


def test_what_stands_there_at_first(opened):
    curve, test = drawn(opened)
    check_curve(curve, "V")
    assert test["kind"] == "dots"
    assert opened.text("h1") == "AMT test rig"
    assert opened.page.title().startswith("AMT test rig")
    peak = re.search(r"peak ([\d.]+) rad/\(N·m\) at ([\d.]+) Hz \((−[\d.]+)°\)", opened.text("#summary"))
    assert float(peak[1]) == pytest.approx(0.006345, rel=1e-3)  # of the highest of the lines drawn
    assert float(peak[2]) == pytest.approx(6.784, rel=2e-3)
    assert "apart by" in opened.text("#curves")
    rows = opened.page.locator("#modes tbody tr").all_inner_texts()
    assert rows[0].split("\t")[:4] == ["1", "5.912", "5.7704", "21.76"]
    assert "strain in dmf" in rows[0]
    assert opened.page.locator("#poles .pole").count() == 2
    assert opened.page.locator(".parameter").count() == 11


def test_a_slider_by_keyboard_and_by_mouse(opened):
    c_O = slider(opened, "c_O")
    c_O.focus()
    with opened.update():
        for _ in range(3):
            opened.page.keyboard.press("ArrowRight")
    typed = float(opened.page.input_value("#parameter-c_O"))
    assert 170 < typed < 175
    check_curve(drawn(opened)[0], "V", c_O=typed)
    box = slider(opened, "k_1").bounding_box()
    y = box["y"] + box["height"] / 2
    opened.page.mouse.move(box["x"] + box["width"] / 2, y)
    with opened.update():
        opened.page.mouse.down()
        for step in range(10):
            opened.page.mouse.move(box["x"] + box["width"] * (0.5 + 0.03 * step), y)
        opened.page.mouse.up()
    k_1 = float(opened.page.input_value("#parameter-k_1"))
    assert 1.2 < k_1 < 2.2
    check_curve(drawn(opened)[0], "V", c_O=typed, k_1=1000 * k_1)
    with opened.update():
        slider(opened, "k_1").dblclick()
    with opened.update():
        opened.page.get_by_role("button", name="Reset c_O").click()
    check_curve(drawn(opened)[0], "V")
    assert opened.page.get_by_role("button", name="Reset all").is_disabled()


def test_derived_parameters_follow(opened):
    assert opened.page.get_attribute("#parameter-I_F", "readonly") is not None
    with opened.update():
        opened.page.fill("#parameter-I_1", "0.3")
        opened.page.keyboard.press("Enter")
    assert opened.page.input_value("#parameter-I_F") == "0.222"


def test_other_units_can_be_typed(opened):
    with opened.update():
        opened.page.fill("#parameter-k_1", "4000 lbf*in/rad")
        opened.page.keyboard.press("Tab")
    check_curve(drawn(opened)[0], "V", k_1="4000 lbf*in/rad")
    assert float(opened.page.input_value("#parameter-k_1")) == pytest.approx(0.451939, rel=1e-5)


def test_configurations_are_tabs(opened):
    tab = opened.page.get_by_role("tab", name="V", exact=True)
    assert tab.get_attribute("aria-selected") == "true"
    with opened.update():
        opened.page.get_by_role("tab", name="II", exact=True).click()
    check_curve(drawn(opened)[0], "II")
    assert opened.page.input_value("#parameter-tau") == "7.96"
    with opened.update():
        opened.page.keyboard.press("ArrowRight")
    check_curve(drawn(opened)[0], "III")
    assert opened.page.evaluate("document.activeElement.textContent") == "III"


def test_what_is_impossible_is_said_and_the_last_curve_stays(opened):
    opened.page.fill("#parameter-k_1", "-3")
    opened.page.keyboard.press("Enter")
    opened.until(lambda: opened.page.is_visible("#refused"), "the refusal")
    assert opened.text("#refused") == "dmf stiffness: k_1 = -3000: torsional stiffness must not be less than 0"
    assert opened.page.get_attribute("#parameter-k_1", "aria-invalid") is not None
    check_curve(drawn(opened)[0], "V")
    assert opened.page.evaluate("torsionnet.drawn()[0].faint") is True
    for text, said in (("1,5", "decimal comma"), ("3 kg", "dimension of kg"), ("many", "many")):
        opened.page.fill("#parameter-k_1", text)
        opened.page.keyboard.press("Enter")
        opened.until(lambda said=said: said in opened.text("#refused"), text)
    with opened.update():
        opened.page.get_by_role("button", name="Reset all").click()
    assert opened.page.is_hidden("#refused")
    assert not opened.page.evaluate("torsionnet.drawn()[0].faint")


def test_response_quantity_units_and_band(opened):
    with opened.update():
        opened.page.select_option("select[name=input]", "T_M")
    check_curve(drawn(opened)[0], "V", into="T_M")
    assert opened.page.locator("#which").is_hidden()
    opened.until(lambda: "holds no theta_1/T_M" in opened.text("#notes"), "the note about the test")
    opened.page.locator("label", has_text="deg").click()
    check_curve(drawn(opened)[0], "V", into="T_M", scale=180 / np.pi)
    assert "deg/(N·m)" in opened.text("#magnitude-title")
    opened.page.locator("label", has_text="dB").click()
    curve = drawn(opened)[0]
    check_curve(curve | {"magnitude": 10 ** (np.array(curve["magnitude"]) / 20)}, "V", into="T_M", scale=180 / np.pi)
    with opened.update():
        opened.page.select_option("select[name=motion-as]", "accelerance")
    assert opened.text("#magnitude-title").startswith("accelerance")
    with opened.update():
        opened.page.fill("[aria-label='Lowest frequency in Hz']", "3")
        opened.page.keyboard.press("Enter")
    assert drawn(opened)[0]["frequencies"][0] == 3
    with opened.update():
        opened.page.get_by_role("button", name="fit").click()
    assert drawn(opened)[0]["frequencies"][0] == 1


def test_zoom_by_dragging_and_back_by_double_click(opened):
    box = opened.page.locator("#magnitude .u-over").bounding_box()
    y = box["y"] + 50
    with opened.update():
        opened.page.mouse.move(box["x"] + 0.4 * box["width"], y)
        opened.page.mouse.down()
        opened.page.mouse.move(box["x"] + 0.8 * box["width"], y, steps=5)
        opened.page.mouse.up()
    low, high = drawn(opened)[0]["frequencies"][0], drawn(opened)[0]["frequencies"][-1]
    assert low == pytest.approx(20**0.4, rel=0.05)  # of 1 to 20 Hz
    assert high == pytest.approx(20**0.8, rel=0.05)
    with opened.update():
        opened.page.mouse.dblclick(box["x"] + 0.5 * box["width"], y)
    assert drawn(opened)[0]["frequencies"][-1] == 20


def test_cursor_by_mouse_and_by_keys(opened):
    assert "(peak)" in opened.text("#at")
    box = opened.page.locator("#phase .u-over").bounding_box()
    opened.page.mouse.move(box["x"] + box["width"] / 2, box["y"] + 20)
    opened.until(lambda: "(peak)" not in opened.text("#at"), "the cursor")
    frequency = float(re.search(r"at ([\d.]+) Hz", opened.text("#at"))[1])
    assert frequency == pytest.approx(np.sqrt(1 * 20), rel=0.01)
    expected = abs(tn.load("amt_rig").configured("V").frequency_response("theta_1", "T_T", [frequency]).values[0, 0, 0])
    shown = float(opened.page.locator("#curves tbody tr td").first.inner_text())
    assert shown == pytest.approx(expected, rel=0.01)
    opened.page.locator("#magnitude").focus()
    opened.page.keyboard.press("Shift+ArrowRight")
    later = float(opened.page.get_attribute("#magnitude", "aria-valuenow"))
    assert later > frequency
    assert "degrees" in opened.page.get_attribute("#magnitude", "aria-valuetext")
    opened.page.keyboard.press("Escape")
    opened.until(lambda: "(peak)" in opened.text("#at"), "the end of the cursor")


def test_pins_are_named_removed_and_follow_the_response(opened):
    with opened.update():
        opened.page.click("#pin")
    with opened.update():
        opened.page.fill("#parameter-c_O", "360")
        opened.page.keyboard.press("Enter")
    now, pin, _ = drawn(opened)
    check_curve(now, "V", c_O=360)
    check_curve(pin, "V")
    opened.page.fill(".pin-name", "as tested")
    opened.page.keyboard.press("Enter")
    with opened.update():
        opened.page.select_option("select[name=input]", "T_M")
    opened.until(lambda: len(drawn(opened)) == 2, "the pin over T_M")
    check_curve(drawn(opened)[1], "V", into="T_M")
    assert opened.page.input_value(".pin-name") == "as tested"
    assert opened.page.locator("#poles .pole.pinned").count() == 2
    opened.page.get_by_role("button", name="Remove as tested").click()
    opened.until(lambda: len(drawn(opened)) == 1, "the end of the pin")


def test_the_test_can_be_hidden(opened):
    opened.page.get_by_role("button", name="Hide the test").click()
    assert len(drawn(opened)) == 1
    opened.page.get_by_role("button", name="Show the test").click()
    assert len(drawn(opened)) == 2


def test_poles_of_the_cut_rig(opened):
    opened.page.locator("label", has_text="cut at T_T").click()
    natural = tn.load("amt_rig").configured("V").modes(measured_input="T_T").natural_frequencies
    first = opened.page.locator("#modes tbody td.natural").first.inner_text()
    assert float(first) == pytest.approx(natural[0], rel=1e-4)


def test_saved_file_gives_the_same_numbers(opened, tmp_path):
    with opened.update():
        opened.page.fill("#parameter-c_O", "360")
        opened.page.keyboard.press("Enter")
    with opened.update():
        opened.page.fill("#parameter-tau", "3.3")
        opened.page.keyboard.press("Enter")
    with opened.page.expect_download() as download:
        opened.page.click("#save")
    assert download.value.suggested_filename == "amt_rig_changed.yaml"
    path = tmp_path / "saved.yaml"
    download.value.save_as(path)
    saved = tn.load(path).configured("V")
    assert saved.parameters == tn.load("amt_rig").configured("V", c_O=360, tau=3.3).parameters
    curve = drawn(opened)[0]
    found = saved.frequency_response("theta_1", "T_T", curve["frequencies"]).magnitude[:, 0, 0]
    np.testing.assert_allclose(curve["magnitude"], found, rtol=1e-12)
    opened.until(lambda: opened.text("#said") == "Saved amt_rig_changed.yaml.", "the word about it")


def test_command_is_copied_and_runs(opened, capsys):
    opened.page.context.grant_permissions(["clipboard-read", "clipboard-write"])
    with opened.update():
        opened.page.fill("#parameter-c_O", "360")
        opened.page.keyboard.press("Enter")
    opened.page.click("#copy")
    opened.until(lambda: opened.text("#said") == "Copied the command.", "the copy")
    import shlex

    words = shlex.split(opened.page.evaluate("navigator.clipboard.readText()"))
    assert words[:3] == ["torsionnet", "frf", "amt_rig"]
    assert main([*words[1:], "--json"]) == 0
    (pair,) = json.loads(capsys.readouterr().out)[0]["responses"]
    assert pair["peaks"][0]["magnitude"] == pytest.approx(max(drawn(opened)[0]["magnitude"]), rel=1e-3)


def test_reload_keeps_everything(opened):
    with opened.update():
        opened.page.get_by_role("tab", name="III", exact=True).click()
    with opened.update():
        opened.page.click("#pin")
    with opened.update():
        opened.page.fill("#parameter-c_O", "300")
        opened.page.keyboard.press("Enter")
    opened.page.locator("label", has_text="deg").click()
    opened.page.get_by_role("button", name="Dark colours").click()
    time.sleep(0.8)
    before = drawn(opened)
    opened.page.reload()
    opened.until(lambda: opened.updates and len(drawn(opened)) == 3, "the page again")
    assert drawn(opened) == before
    assert opened.page.input_value("#parameter-c_O") == "300"
    assert opened.page.evaluate("document.documentElement.dataset.theme") == "dark"


def test_an_address_of_another_model_does_no_harm(browser, amt):
    words = "#c=gear%3DX&c=clutch%3Dopen&set=nothing%3D3&out=x&in=y&as=z&band=5+1&pin=%7B&pin=%7B%22values%22%3A3%7D&theme=pink"
    with visit(browser, amt.address + words, viewport=WIDE) as found:
        check_curve(drawn(found)[0], "")
        assert found.console == []


def test_dark_and_light(browser, amt):
    for scheme, dark in (("light", False), ("dark", True)):
        with visit(browser, amt.address, viewport=WIDE, color_scheme=scheme) as found:
            theme = "document.documentElement.dataset.theme"
            ground = "getComputedStyle(document.body).backgroundColor"
            assert found.page.evaluate(theme) == scheme
            levels = [int(one) for one in re.findall(r"\d+", found.page.evaluate(ground))[:3]]
            assert (max(levels) < 60) is dark
            found.page.click("#theme")
            assert found.page.evaluate(theme) == ("light" if dark else "dark")


def test_a_server_that_has_ended_is_told(browser):
    with serving("dmf_rig") as server, visit(browser, server.address, viewport=WIDE) as found:
        found.page.route("**/api/answer", lambda route: route.abort())
        found.page.fill("#parameter-k_1", "14")
        found.page.keyboard.press("Enter")
        found.until(lambda: found.page.is_visible("#refused"), "the message")
        assert "torsionnet explore has ended" in found.text("#refused")


@pytest.mark.parametrize("width", [1440, 900, 400])
def test_nothing_sticks_out(browser, amt, width):
    with visit(browser, amt.address, viewport={"width": width, "height": 850}) as found:
        assert found.page.evaluate("document.documentElement.scrollWidth") <= width
        canvas = found.page.locator("#magnitude canvas")
        found.until(lambda: canvas.bounding_box() is not None, "the picture")
        assert canvas.bounding_box()["width"] > 0.6 * min(width, 1000) - 60


def test_every_control_has_a_name(opened):
    unnamed = opened.page.evaluate(
        """() => [...document.querySelectorAll("button, input, select, [role=slider], [role=img], [role=tablist]")]
        .filter((one) => !(one.labels?.length || one.textContent.trim() || one.ariaLabel || one.getAttribute("aria-labelledby")))
        .map((one) => one.outerHTML)"""
    )
    assert unnamed == []


@pytest.mark.slow
@pytest.mark.parametrize("name", ["amt_rig", "dmf_rig", "six_cylinder_diesel"])
def test_time_of_an_update(browser, name):
    """From the event of the slider to the drawn curves, as the page measures it."""
    with serving(name) as server, visit(browser, server.address, viewport=WIDE) as found:
        found.settle()
        found.page.locator(".parameter:not(.is-derived) .slider").nth(1).focus()
        times = []
        for _ in range(30):
            before = found.updates
            found.page.keyboard.press("ArrowRight")
            found.until(lambda before=before: found.updates > before, "an update")
            times.append(found.page.evaluate("torsionnet.lastUpdate"))
        print(f"{name}: median {np.median(times):.0f} ms, slowest of 30 {max(times):.0f} ms")  # noqa: T201 (with -s)
        assert np.median(times) < SLOW
        assert found.console == []


@pytest.mark.slow
def test_every_library_model_opens(browser):
    for name in tn.library_models():
        with serving(name) as server, visit(browser, server.address, viewport=WIDE) as found:
            assert len(drawn(found)) == 1, name
            assert found.console == [], name
