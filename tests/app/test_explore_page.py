"""The explore page clicked through in headless Chromium; skipped, with a reason, where there is none."""

import json
import re
from contextlib import contextmanager

import numpy as np
import pytest
from support import campaigns
from support.explore_pages import SLOW, WIDE, drawn, kept_quiet, serving, slider, visit

import torsionnet as tn
from torsionnet.app.cli import main
from torsionnet.app.explore.session import ResponseChoice
from torsionnet.io import write_frequency_response

POSIX = "Object.defineProperty(Navigator.prototype, 'language', {get: () => 'en-US@posix', configurable: true})"
"""A language that is no tag of one, as of browsers on Linux without a locale."""


@contextmanager
def serving_amt(folder):
    """The AMT rig with a test of gear V laid over it."""
    f = np.linspace(0.5, 40, 80)
    path = folder / "gear_V.csv"
    write_frequency_response(tn.load("amt_rig").configured("V").frequency_response("theta_1", "T_T", f), path)
    with serving("amt_rig", configuration="V", pairs=[ResponseChoice("theta_1", "T_T")], overlay=path) as server:
        yield server


@pytest.fixture(scope="module")
def amt(tmp_path_factory):
    with serving_amt(tmp_path_factory.mktemp("test")) as server:
        yield server


@contextmanager
def opening(chromium, amt):
    with visit(chromium, amt.address, before=POSIX) as found:
        found.until(lambda: len(drawn(found)) == 2, "the test")
        yield found


@pytest.fixture
def opened(chromium, amt):
    """A page of one's own; afterwards nothing was said on the console and nothing was asked of anyone else."""
    with opening(chromium, amt) as found:
        yield found
        assert kept_quiet(found, amt)


@pytest.fixture(scope="module")
def common_page(chromium, amt):
    with opening(chromium, amt) as found:
        yield found, drawn(found)


@pytest.fixture
def lent(common_page, amt):
    """A page for all, to be given back as it was; loading one takes longer than most tests."""
    found, at_first = common_page
    yield found
    assert drawn(found) == at_first
    assert kept_quiet(found, amt)


def check_curve(curve, configuration, output="theta_1", into="T_T", scale=1.0, **values):
    f = np.array(curve["frequencies"])
    rig = tn.load("amt_rig").configured(configuration, **values)
    expected = rig.frequency_response(output, into, f).magnitude[:, 0, 0]
    np.testing.assert_allclose(curve["magnitude"], scale * expected, rtol=1e-12)


@pytest.mark.slow
def test_what_stands_there_at_first(lent):
    curve, test = drawn(lent)
    check_curve(curve, "V")
    assert test["kind"] == "dots"
    assert lent.text("h1") == "AMT test rig"
    assert lent.page.title().startswith("AMT test rig")
    peak = re.search(r"peak ([\d.]+) rad/\(N·m\) at ([\d.]+) Hz \((−[\d.]+)°\)", lent.text("#summary"))
    assert float(peak[1]) == pytest.approx(0.006345, rel=1e-3)  # of the highest of the lines drawn
    assert float(peak[2]) == pytest.approx(6.784, rel=2e-3)
    assert "apart by" in lent.text("#curves")
    first = lent.page.locator("#modes tbody tr").first
    assert first.locator("th, td").all_text_contents()[:4] == ["1", "5.912", "5.7704", "21.76"]
    assert "strain in dmf" in first.get_attribute("title")
    assert lent.page.locator("#poles .pole").count() == 2
    assert lent.page.locator(".parameter").count() == 11


@pytest.mark.slow
def test_a_slider_by_keyboard_and_by_mouse(lent):
    c_O = slider(lent, "c_O")
    c_O.focus()
    with lent.update():
        for _ in range(3):
            lent.page.keyboard.press("ArrowRight")
    typed = float(lent.page.input_value("#parameter-c_O"))
    assert 170 < typed < 175
    check_curve(drawn(lent)[0], "V", c_O=typed)
    box = slider(lent, "k_1").bounding_box()
    y = box["y"] + box["height"] / 2
    lent.page.mouse.move(box["x"] + box["width"] / 2, y)
    with lent.update():
        lent.page.mouse.down()
        for step in range(10):
            lent.page.mouse.move(box["x"] + box["width"] * (0.5 + 0.03 * step), y)
        lent.page.mouse.up()
    k_1 = float(lent.page.input_value("#parameter-k_1"))
    assert 1.2 < k_1 < 2.5
    check_curve(drawn(lent)[0], "V", c_O=typed, k_1=1000 * k_1)
    with lent.update():
        slider(lent, "k_1").dblclick()
    with lent.update():
        lent.page.get_by_role("button", name="Reset c_O").click()
    check_curve(drawn(lent)[0], "V")
    assert lent.page.get_by_role("button", name="Reset all").is_disabled()


@pytest.mark.slow
def test_derived_parameters_follow(lent):
    assert lent.page.get_attribute("#parameter-I_F", "readonly") is not None
    with lent.update():
        lent.page.fill("#parameter-I_1", "0.3")
        lent.page.keyboard.press("Enter")
    assert lent.page.input_value("#parameter-I_F") == "0.222"
    with lent.update():
        lent.page.get_by_role("button", name="Reset all").click()


def test_other_units_can_be_typed(lent):
    with lent.update():
        lent.page.fill("#parameter-k_1", "4000 lbf*in/rad")
        lent.page.keyboard.press("Tab")
    check_curve(drawn(lent)[0], "V", k_1="4000 lbf*in/rad")
    assert float(lent.page.input_value("#parameter-k_1")) == pytest.approx(0.451939, rel=1e-5)
    with lent.update():
        lent.page.get_by_role("button", name="Reset all").click()


@pytest.mark.slow
def test_configurations_are_tabs(lent):
    tab = lent.page.get_by_role("tab", name="V", exact=True)
    assert tab.get_attribute("aria-selected") == "true"
    with lent.update():
        lent.page.get_by_role("tab", name="II", exact=True).click()
    check_curve(drawn(lent)[0], "II")
    assert lent.page.input_value("#parameter-tau") == "7.96"
    with lent.update():
        lent.page.keyboard.press("ArrowRight")
    check_curve(drawn(lent)[0], "III")
    assert lent.page.evaluate("document.activeElement.textContent") == "III"
    with lent.update():
        lent.page.get_by_role("tab", name="V", exact=True).click()


@pytest.mark.slow
def test_what_is_impossible_is_said_and_the_last_curve_stays(lent):
    lent.page.fill("#parameter-k_1", "-3")
    lent.page.keyboard.press("Enter")
    lent.until(lambda: lent.page.is_visible("#refused"), "the refusal")
    assert lent.text("#refused").startswith("dmf stiffness: k_1 = -3000: ")
    assert lent.page.get_attribute("#parameter-k_1", "aria-invalid") is not None
    check_curve(drawn(lent)[0], "V")
    assert lent.page.evaluate("torsionnet.drawn()[0].faint") is True
    for text, said in (("1,500", "ambiguous"), ("3 kg", "dimension of kg"), ("many", "many")):
        lent.page.fill("#parameter-k_1", text)
        lent.page.keyboard.press("Enter")
        lent.until(lambda said=said: said in lent.text("#refused"), text)
    with lent.update():
        lent.page.get_by_role("button", name="Reset all").click()
    assert lent.page.is_hidden("#refused")
    assert not lent.page.evaluate("torsionnet.drawn()[0].faint")


@pytest.mark.slow
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
        opened.page.get_by_role("button", name="all", exact=True).click()
    assert drawn(opened)[0]["frequencies"][0] == 1


@pytest.mark.slow
def test_zoom_by_dragging_and_back_by_double_click(lent):
    box = lent.page.locator("#magnitude .u-over").bounding_box()
    y = box["y"] + 50
    with lent.update():
        lent.page.mouse.move(box["x"] + 0.4 * box["width"], y)
        lent.page.mouse.down()
        lent.page.mouse.move(box["x"] + 0.8 * box["width"], y, steps=5)
        lent.page.mouse.up()
    low, high = drawn(lent)[0]["frequencies"][0], drawn(lent)[0]["frequencies"][-1]
    assert low == pytest.approx(20**0.4, rel=0.05)  # of 1 to 20 Hz
    assert high == pytest.approx(20**0.8, rel=0.05)
    with lent.update():
        lent.page.mouse.dblclick(box["x"] + 0.5 * box["width"], y)
    assert drawn(lent)[0]["frequencies"][-1] == 20


def test_cursor_by_mouse_and_by_keys(lent):
    assert "(peak)" in lent.text("#at")
    box = lent.page.locator("#phase .u-over").bounding_box()
    lent.page.mouse.move(box["x"] + box["width"] / 2, box["y"] + 20)
    lent.until(lambda: "(peak)" not in lent.text("#at"), "the cursor")
    frequency = float(re.search(r"at ([\d.]+) Hz", lent.text("#at"))[1])
    assert frequency == pytest.approx(np.sqrt(1 * 20), rel=0.01)
    expected = abs(tn.load("amt_rig").configured("V").frequency_response("theta_1", "T_T", [frequency]).values[0, 0, 0])
    shown = float(lent.page.locator("#curves tbody tr td").first.inner_text())
    assert shown == pytest.approx(expected, rel=0.01)
    lent.page.locator("#magnitude").focus()
    lent.page.keyboard.press("Shift+ArrowRight")
    later = float(lent.page.get_attribute("#magnitude", "aria-valuenow"))
    assert later > frequency
    assert "degrees" in lent.page.get_attribute("#magnitude", "aria-valuetext")
    lent.page.keyboard.press("Escape")
    lent.until(lambda: "(peak)" in lent.text("#at"), "the end of the cursor")


@pytest.mark.slow
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


def test_the_test_can_be_hidden(lent):
    lent.page.get_by_role("button", name="Hide the test").click()
    assert len(drawn(lent)) == 1
    lent.page.get_by_role("button", name="Show the test").click()
    assert len(drawn(lent)) == 2


def test_poles_of_the_cut_rig(lent):
    lent.page.locator("label", has_text="cut at T_T").click()
    natural = tn.load("amt_rig").configured("V").modes(measured_input="T_T").natural_frequencies
    first = lent.page.locator("#modes tbody td.natural").first.inner_text()
    assert float(first) == pytest.approx(natural[0], rel=1e-4)
    lent.page.locator("#which label", has_text="drivetrain").click()


@pytest.fixture
def lone(chromium, tmp_path):
    """A page with a server of its own, into whose text values are written."""
    with serving_amt(tmp_path) as server, opening(chromium, server) as found:
        yield found


@pytest.mark.slow
def test_saved_file_gives_the_same_numbers(lone, tmp_path):
    with lone.update():
        lone.page.fill("#parameter-c_O", "360")
        lone.page.keyboard.press("Enter")
    with lone.update():
        lone.page.fill("#parameter-tau", "3.3")
        lone.page.keyboard.press("Enter")
    lone.keep("write")
    lone.until(lambda: "c_O: {value: 360" in lone.page.evaluate("torsionnet.text()"), "the values in the text")
    with lone.page.expect_download() as download:
        lone.page.click("#save")
    assert download.value.suggested_filename == "amt_rig.yaml"
    path = tmp_path / "saved.yaml"
    download.value.save_as(path)
    saved = tn.load(path).configured("V")
    assert saved.parameters == tn.load("amt_rig").configured("V", c_O=360, tau=3.3).parameters
    curve = drawn(lone)[0]
    found = saved.frequency_response("theta_1", "T_T", curve["frequencies"]).magnitude[:, 0, 0]
    np.testing.assert_allclose(curve["magnitude"], found, rtol=1e-12)
    lone.until(
        lambda: lone.text("#said").startswith("Saved as a download, amt_rig.yaml: a library model"),
        "the word about it",
    )


@pytest.mark.slow
def test_command_is_copied_and_runs(opened, capsys):
    opened.page.context.grant_permissions(["clipboard-read", "clipboard-write"])
    with opened.update():
        opened.page.fill("#parameter-c_O", "360")
        opened.page.keyboard.press("Enter")
    opened.keep("copy")
    opened.until(lambda: opened.text("#said") == "Copied the command.", "the copy")
    import shlex

    words = shlex.split(opened.page.evaluate("navigator.clipboard.readText()"))
    assert words[:3] == ["torsionnet", "frf", "amt_rig"]
    assert main([*words[1:], "--json"]) == 0
    (pair,) = json.loads(capsys.readouterr().out)[0]["responses"]
    assert pair["peaks"][0]["magnitude"] == pytest.approx(max(drawn(opened)[0]["magnitude"]), rel=1e-3)


@pytest.mark.slow
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
    opened.until(lambda: "theme=dark" in opened.page.evaluate("location.hash"), "the address of the last choice")
    opened.settle()
    before = drawn(opened)
    opened.page.reload()
    opened.until(lambda: opened.updates and len(drawn(opened)) == 3, "the page again")
    assert drawn(opened) == before
    assert opened.page.input_value("#parameter-c_O") == "300"
    assert opened.page.evaluate("document.documentElement.dataset.theme") == "dark"


@pytest.mark.slow
def test_an_address_of_another_model_does_no_harm(chromium, amt):
    words = "#c=gear%3DX&c=clutch%3Dopen&set=nothing%3D3&out=x&in=y&as=z&band=5+1&pin=%7B&pin=%7B%22values%22%3A3%7D&theme=pink"
    with visit(chromium, amt.address + words, viewport=WIDE) as found:
        check_curve(drawn(found)[0], "")
        assert found.console == []


@pytest.mark.parametrize(
    ("scheme", "other"), [pytest.param("light", "dark", marks=pytest.mark.slow), ("dark", "light")]
)
@pytest.mark.slow
def test_dark_and_light(chromium, amt, scheme, other):
    with visit(chromium, amt.address, viewport=WIDE, color_scheme=scheme) as found:
        theme = "document.documentElement.dataset.theme"
        ground = "getComputedStyle(document.body).backgroundColor"
        assert found.page.evaluate(theme) == scheme
        levels = [int(one) for one in re.findall(r"\d+", found.page.evaluate(ground))[:3]]
        assert (max(levels) < 60) is (scheme == "dark")
        found.page.click("#theme")
        assert found.page.evaluate(theme) == other


@pytest.mark.slow
def test_a_server_that_has_ended_is_told(chromium):
    with serving("dmf_rig") as server, visit(chromium, server.address, viewport=WIDE) as found:
        found.page.route("**/api/answer", lambda route: route.abort())
        found.page.fill("#parameter-k_1", "14")
        found.page.keyboard.press("Enter")
        found.until(lambda: found.page.is_visible("#refused"), "the message")
        assert "torsionnet explore has ended" in found.text("#refused")


@pytest.mark.slow
@pytest.mark.parametrize("width", [pytest.param(width, marks=pytest.mark.slow) for width in (1440, 900)] + [400])
def test_nothing_sticks_out(chromium, amt, width):
    with visit(chromium, amt.address, viewport={"width": width, "height": 850}) as found:
        assert found.page.evaluate("document.documentElement.scrollWidth") <= width
        canvas = found.page.locator("#magnitude canvas")
        found.until(lambda: canvas.bounding_box() is not None, "the picture")
        assert canvas.bounding_box()["width"] > 0.6 * min(width, 600) - 60


def test_every_control_has_a_name(lent):
    unnamed = lent.page.evaluate(
        """() => [...document.querySelectorAll("button, input, select, [role=slider], [role=img], [role=tablist]")]
        .filter((one) => !(one.labels?.length || one.textContent.trim() || one.ariaLabel || one.getAttribute("aria-labelledby")))
        .map((one) => one.outerHTML)"""
    )
    assert unnamed == []


@pytest.mark.slow
@pytest.mark.parametrize("name", campaigns.by_day(["amt_rig", "dmf_rig", "six_cylinder_diesel"], "amt_rig"))
def test_time_of_an_update(chromium, name):
    """From the event of the slider to the drawn curves, as the page measures it."""
    with serving(name) as server, visit(chromium, server.address, viewport=WIDE) as found:
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
@pytest.mark.parametrize("name", campaigns.by_day(tn.library_models(), "front_wheel_drive_car", "two_stroke_ship"))
def test_every_library_model_opens(chromium, name):
    with serving(name) as server, visit(chromium, server.address, viewport=WIDE) as found:
        assert drawn(found)
        assert found.console == []
