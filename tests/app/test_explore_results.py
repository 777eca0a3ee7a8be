"""Results before all else on the explore page of a ship, by mouse and keys in headless Chromium, on one page."""

from pathlib import Path

import numpy as np
import pytest
from support.explore_pages import WIDE, kept_quiet, serving, visit

import torsionnet as tn

PLANTS = Path(__file__).parents[1] / "plants"
SHIP = "marine_medium_speed"
CONTRAST = """() => {
  const light = (c) => c.slice(0, 3).map((v) => v / 255).map((v) => (v <= 0.03928 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4))
    .reduce((sum, v, k) => sum + v * [0.2126, 0.7152, 0.0722][k], 0);
  const rgb = (text) => (text.match(/[\\d.]+/g) ?? []).map((v) => v * (text.startsWith("color(") ? 255 : 1));
  const ground = (node) => {
    for (let one = node; one; one = one.parentElement) {
      const found = rgb(getComputedStyle(one).backgroundColor);
      if (found.length === 3 || found[3] === 1) return found;
    }
    return [255, 255, 255];
  };
  const faint = new Set();
  const words = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
  while (words.nextNode()) {
    const node = words.currentNode.parentElement;
    if (!words.currentNode.textContent.trim() || !node.getClientRects().length) continue;
    let opacity = 1;
    for (let one = node; one; one = one.parentElement) opacity *= Number(getComputedStyle(one).opacity);
    const ink = rgb(getComputedStyle(node)[node.closest("svg") ? "fill" : "color"]);
    if (ink.length < 3) continue;
    const paper = ground(node);
    const seen = ink.slice(0, 3).map((v, k) => v * opacity + paper[k] * (1 - opacity));
    const [high, low] = [light(seen), light(paper)].sort((a, b) => b - a);
    if ((high + 0.05) / (low + 0.05) < 4.5) faint.add(`${node.tagName} ${words.currentNode.textContent.trim()}`);
  }
  return [...faint];
}"""
"""Words whose contrast is below that of WCAG AA."""
NAMES = """() => {
  const seen = [...document.querySelectorAll("button")].filter((one) => one.getClientRects().length);
  const names = seen.map((one) => one.getAttribute("aria-label") ?? one.textContent.trim());
  return names.filter((one, k) => names.indexOf(one) !== k);
}"""
BOXES = """(inner) => document.querySelector(inner).getBoundingClientRect().toJSON()"""
COVERED = """() => {
  const words = [...document.querySelectorAll("#schematic text:not([data-crowded])")];
  const parts = [...document.querySelectorAll("#schematic .pen-part")];
  const shared = (a, b) => Math.min(Math.min(a.right, b.right) - Math.max(a.left, b.left), Math.min(a.bottom - 3, b.bottom) - Math.max(a.top + 3, b.top));
  const meet = (one, part) => one.closest("[id]") !== part.closest("[id]") && shared(one.getBoundingClientRect(), part.getBoundingClientRect()) > 2;
  return words.filter((one) => parts.some((part) => meet(one, part))).map((one) => one.textContent);
}"""
"""Words of the schematic over symbols of other elements."""
CUT = """() => [...document.querySelectorAll(".parameter > :is(.name, .unit)")]
  .filter((one) => one.scrollWidth > one.clientWidth).map((one) => one.textContent)"""
"""Names and units of parameters that end in dots."""
SIZES = """() => [...document.querySelectorAll("#schematic text:not([data-crowded]), #schematic text:not([data-crowded]) [font-size]")]
  .map((one) => parseFloat(getComputedStyle(one).fontSize) * one.ownerSVGElement.getScreenCTM().a)"""
VIEW = """() => document.querySelector("#schematic svg").getAttribute("viewBox").split(" ").map(Number)"""
PATHS = """() => [...document.querySelectorAll("#shape .curve")].map((one) => one.getAttribute("d"))"""


@pytest.fixture(scope="module")
def ship(chromium):
    with (
        serving(SHIP) as server,
        visit(chromium, server.address + "#over=frequency&out=T_crank&in=T_prop", viewport=WIDE) as found,
    ):
        found.page.click("#choosing")
        found.settle()
        found.until(lambda: found.page.evaluate(PATHS), "the mode shape")
        yield found
        assert kept_quiet(found, server)


@pytest.fixture(scope="module")
def rig():
    return tn.load(SHIP)


@pytest.mark.slow
def test_everything_fits_on_one_screen(ship):
    """Schematic, mode shape, magnitude, phase, every mode and every slider, with the choosers collapsed to a line."""
    page = ship.page
    assert page.is_hidden("#tabs")
    assert page.inner_text("#choosing") == "as written · T_crank over T_prop"
    assert page.locator(".parameter").count() == 28
    for inner, outer in (
        ("#phase", "#sheet"), ("#modes tbody tr:last-child", "#modes-scroll"), (".parameter:last-of-type", "#sliders"),
    ):  # fmt: skip
        found, frame = page.evaluate(BOXES, inner), page.evaluate(BOXES, outer)
        assert found["height"] > 10
        assert found["bottom"] <= min(frame["bottom"] + 1, WIDE["height"]), inner
    x, _, width, _ = page.evaluate(VIEW)
    nodes = page.locator("#schematic .is-node").evaluate_all("(all) => all.map((one) => one.getBBox().x)")
    assert x <= min(nodes)
    assert max(nodes) <= x + width
    assert min(page.evaluate(SIZES)) > 10.99


@pytest.mark.slow
def test_zoom_and_pan_by_keys_and_mouse(ship):
    page = ship.page
    whole = page.evaluate(VIEW)
    page.locator("#schematic [tabindex='0']").focus()
    for _ in range(4):
        page.keyboard.press("+")
    closer = page.evaluate(VIEW)
    assert closer[2] == pytest.approx(whole[2] / 1.25**4, rel=1e-6)
    assert page.is_visible("#minimap")
    assert min(page.evaluate(SIZES)) > 10.99
    page.keyboard.press("Shift+ArrowRight")
    assert page.evaluate(VIEW)[0] > closer[0]
    box = page.evaluate(BOXES, "#minimap")
    page.mouse.click(box["x"] + 0.9 * box["width"], box["y"] + box["height"] / 2)
    assert page.evaluate(VIEW)[0] > whole[0] + whole[2] / 2
    box = page.evaluate(BOXES, "#schematic")
    page.mouse.move(box["x"] + 100, box["y"] + 20)
    page.mouse.down()
    page.mouse.move(box["x"] + 300, box["y"] + 20, steps=3)
    page.mouse.up()
    page.mouse.wheel(0, -200)
    ship.until(lambda: page.evaluate(VIEW)[2] < closer[2], "the wheel")
    page.click("#fit")
    assert page.evaluate(VIEW) == pytest.approx(whole)
    assert page.is_hidden("#minimap")


@pytest.mark.slow
def test_mode_shapes_along_the_line(ship, rig):
    """The curve is the real part of the shape, each node below itself; a second mode moves together with the first."""
    page = ship.page
    modes = rig.modes()
    k = modes.numbers.index(1)
    (first,) = page.evaluate(PATHS)
    heights = [float(point.split(" ")[1]) for point in first.replace("L", "M").split("M")[1:]]
    shape = np.real(modes.shapes[:, k]) / np.abs(modes.shapes[:, k]).max()
    spread = (max(heights) - min(heights)) / page.evaluate("document.querySelector('#shape').clientHeight - 38")
    assert spread == pytest.approx((shape.max() - shape.min()) / 2, abs=0.02)
    page.get_by_role("button", name="Mode 2 on the schematic").click(modifiers=["Shift"])
    before = page.evaluate(PATHS)
    assert len(before) == 2
    ship.until(lambda: all(a != b for a, b in zip(before, page.evaluate(PATHS), strict=True)), "both to move")
    page.click("#play")
    page.get_by_role("button", name="Mode 2 on the schematic").click(modifiers=["Shift"])
    assert len(page.evaluate(PATHS)) == 1


@pytest.mark.slow
def test_one_key_makes_a_pane_as_large_as_the_page(ship):
    page = ship.page
    page.locator("#magnitude").focus()
    page.keyboard.press("F9")
    assert page.is_hidden("#text")
    assert page.is_hidden("#parameters")
    assert page.evaluate(BOXES, "#sheet")["width"] > 0.95 * WIDE["width"]
    page.keyboard.press("F9")
    assert page.is_visible("#text")


@pytest.mark.slow
def test_a_ship_opens_on_its_stresses_and_has_an_interference_diagram(ship, rig):
    """Dots stand where an order meets the natural frequency of a vibration within the speeds of the model."""
    page = ship.page
    model = page.evaluate(
        "fetch('api/model', {method: 'POST', headers: {'Content-Type': 'application/json'}, body: '{}'}).then((one) => one.json())"
    )
    assert (model["start"]["axis"], model["start"]["output"]) == ("speed", "stress(int_shaft)")
    page.evaluate("location.hash = '#over=speed&out=stress(int_shaft)'")
    ship.until(lambda: page.get_by_role("tab", name="Interference").count(), "the tab")
    page.get_by_role("tab", name="Interference").click()
    run = rig.order_response("stress(int_shaft)", speeds=rig.definition.speeds.values, refine=False)
    low, high = (min(run.rpm) - 1e-6, max(run.rpm) + 1e-6)
    modes = rig.modes()
    natural = [f for f, damped in zip(modes.natural_frequencies, modes.damped_frequencies, strict=True) if damped > 0]
    met = [(f - line.fixed) * 60 / float(line.relative) for line in run.lines for f in natural]
    ship.until(lambda: page.locator("#meetings circle").count() == sum(low <= rpm <= high for rpm in met), "the dots")
    page.keyboard.press("ArrowRight")
    assert page.locator("#masses tbody tr").count() == len(rig.elements)
    assert "J = 52 kg·m²" in page.inner_text("#masses")
    page.get_by_role("tab", name="Response").click()


@pytest.mark.slow
def test_words_can_be_read_and_nothing_sticks_out(ship):
    page = ship.page
    page.click("#choosing")
    for scheme in ("light", "dark"):
        page.emulate_media(color_scheme=scheme)
        ship.until(lambda scheme=scheme: page.evaluate("document.documentElement.dataset.theme") == scheme, scheme)
        assert page.evaluate(CONTRAST) == []
    assert page.evaluate(NAMES) == []
    page.set_viewport_size({"width": 320, "height": 800})
    for pane in ("Text", "Schematic", "Results"):
        page.get_by_role("tab", name=pane, exact=True).click()
        assert page.evaluate("document.documentElement.scrollWidth") <= 320


@pytest.mark.slow
def test_words_of_a_branched_plant_cover_no_symbol_and_none_is_cut(chromium):
    """Two engines on one gear: a drawing nearly as high as wide, for which a flat pane has to be small."""
    with serving(PLANTS / "tug.yaml") as server, visit(chromium, server.address, viewport=WIDE) as found:
        for width, height in ((1440, 900), (1024, 768)):
            found.page.set_viewport_size({"width": width, "height": height})
            found.settle()
            found.until(lambda: found.page.evaluate(COVERED) == [], f"room for words at {width}")
            assert found.page.locator("#schematic .text-node:not([data-crowded])").count() >= 3
            assert found.page.evaluate(CUT) == []
        assert kept_quiet(found, server)
