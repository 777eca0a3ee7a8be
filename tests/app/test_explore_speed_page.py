"""The explore page over speed in headless Chromium; skipped, with a reason, where there is none."""

import re
import shlex

import numpy as np
import pytest
from support import running_fan
from support.explore_pages import SLOW, WIDE, kept_quiet, serving, visit

import torsionnet as tn
from torsionnet.app.explore.over_speed import ROUGH_SPEEDS

DRAWN = "() => torsionnet.drawn().map(({ name, x, magnitude, width }) => ({ name, x, magnitude, width }))"


@pytest.fixture(scope="module")
def path(tmp_path_factory):
    return running_fan.write(tmp_path_factory.mktemp("fan"))


@pytest.fixture(scope="module")
def fan(path):
    with serving(path, over_speed=["T"]) as server:
        yield server


@pytest.fixture
def opened(chromium, fan):
    with visit(chromium, fan.address, viewport=WIDE) as found:
        settled(found)
        yield found
        assert kept_quiet(found, fan)


def drawn(found):
    return found.page.evaluate(DRAWN)


def settled(found):
    """All speeds are there, not only those for a drag."""
    found.until(lambda: len(drawn(found)[0]["x"]) > ROUGH_SPEEDS, "the answer at all speeds")


def check(found, path, configuration="", output="T", scale=1.0, **values):
    """Curves are the half range and the largest orders of the library."""
    half, *orders = drawn(found)
    run = (
        tn.load(path)
        .configured(configuration, **values)
        .order_response(output, speeds=np.array(half["x"]) * np.pi / 30)
    )
    np.testing.assert_allclose(half["magnitude"], scale * run.half_range[:, 0], rtol=1e-9)
    for line in orders:
        excitation, order = line["name"].split()
        expected = scale * np.abs(run.of_order(float(order), output, excitation))
        np.testing.assert_allclose(line["magnitude"], expected, rtol=1e-9)
        assert line["width"] < half["width"]
    return run


def test_what_stands_there_at_first(opened, path):
    assert len(drawn(opened)) == 6
    run = check(opened, path)
    worst = run.half_range[:, 0].argmax()
    words = rf"T: all orders, half range, at most {run.half_range[worst, 0]:.4g} N·m at {run.rpm[worst]:.4g} r/min"
    assert words in opened.text("#summary")
    assert re.search(r"N·m at 1200 r/min, rated speed;", opened.text("#summary"))
    assert opened.page.locator("#phase").is_hidden()
    assert opened.page.locator("select[name=input]").is_hidden()
    assert opened.page.locator("#curves thead th", has_text="Phase").is_hidden()
    assert opened.text("#magnitude-title").endswith("[N·m]")
    assert opened.page.locator("#modes tbody tr").count() == 2


@pytest.mark.slow
def test_a_slider_and_a_tab(opened, path):
    slider = opened.page.get_by_role("slider", name=re.compile(r"^k\b"))
    slider.focus()
    with opened.update():
        opened.page.keyboard.press("ArrowRight")
    stiffness = float(opened.page.input_value("#parameter-k"))
    assert stiffness > 10
    settled(opened)
    check(opened, path, k=1000 * stiffness)
    with opened.update():
        opened.page.get_by_role("tab", name="rough", exact=True).click()
    settled(opened)
    check(opened, path, "supply=rough", k=1000 * stiffness)
    with opened.update():
        opened.page.get_by_role("tab", name="locked", exact=True).click(no_wait_after=True)
        opened.until(lambda: opened.page.is_visible("#refused"), "the refusal")
        opened.page.get_by_role("tab", name="free", exact=True).click()
    assert opened.page.is_hidden("#refused")


@pytest.mark.slow
def test_a_drag_takes_fewer_speeds_and_all_of_them_come_after_it(opened, path):
    box = opened.page.get_by_role("slider", name=re.compile(r"^k\b")).bounding_box()
    y = box["y"] + box["height"] / 2
    opened.page.mouse.move(box["x"] + box["width"] / 2, y)
    with opened.update():
        opened.page.mouse.down()
        opened.page.mouse.move(box["x"] + 0.6 * box["width"], y)
    assert len(drawn(opened)[0]["x"]) == ROUGH_SPEEDS
    opened.page.mouse.up()
    settled(opened)
    assert len(drawn(opened)[0]["x"]) == 401
    check(opened, path, k=1000 * float(opened.page.input_value("#parameter-k")))


@pytest.mark.slow
def test_colours_stay_with_their_orders(opened):
    def colours():
        return dict(opened.page.evaluate("torsionnet.drawn().slice(1).map(({ name, colour }) => [name, colour])"))

    before = colours()
    with opened.update():
        opened.page.get_by_role("tab", name="rough", exact=True).click()  # a new order comes in
    settled(opened)
    after = colours()
    assert "poles 3" in after
    assert len(set(after.values())) == 5
    (gone,) = before.keys() - after.keys()
    assert after == {name: ink for name, ink in before.items() if name != gone} | {"poles 3": before[gone]}


@pytest.mark.slow
def test_cursor_by_keys_and_what_it_says(opened, path):
    cursor = opened.page.locator("#magnitude")
    assert cursor.get_attribute("aria-label") == "Speed cursor"
    assert "r/min (largest) [N·m]" in opened.text("#at")
    cursor.focus()
    opened.page.keyboard.press("Home")
    first = float(cursor.get_attribute("aria-valuenow"))
    opened.page.keyboard.press("Shift+ArrowRight")
    speed = float(cursor.get_attribute("aria-valuenow"))
    assert 300 <= first < speed < 600
    assert "(largest)" not in opened.text("#at")
    said = re.fullmatch(r"(\S+) r/min: all orders, half range (\S+) N·m, (.*)", cursor.get_attribute("aria-valuetext"))
    run = tn.load(path).order_response("T", speeds=[speed * np.pi / 30])
    assert float(said[2]) == pytest.approx(run.half_range[0, 0], rel=0.02)
    assert said[3].count("N·m") == 5
    shown = opened.page.locator("#curves tbody tr td").first.inner_text()
    assert shown == said[2]
    opened.page.keyboard.press("Escape")
    opened.until(lambda: "(largest)" in opened.text("#at"), "the end of the cursor")


@pytest.mark.slow
def test_pins_compare_half_ranges(opened, path):
    with opened.update():
        opened.page.click("#pin")
    with opened.update():
        opened.page.get_by_role("tab", name="rough", exact=True).click()
    settled(opened)
    opened.until(lambda: len(drawn(opened)) == 7, "the pin")
    *_, pin = drawn(opened)
    assert pin["name"] == "as written"
    expected = tn.load(path).order_response("T").half_range[:, 0]
    np.testing.assert_allclose(pin["magnitude"], expected, rtol=1e-9)
    with opened.update():
        opened.page.select_option("select[name=output]", "twist")
    settled(opened)
    opened.until(lambda: len(drawn(opened)) == 7, "the pin of the other output")
    expected = tn.load(path).order_response("twist").half_range[:, 0]
    np.testing.assert_allclose(drawn(opened)[-1]["magnitude"], expected, rtol=1e-9)


@pytest.mark.slow
def test_degrees_zoom_and_the_whole_range(opened, path):
    with opened.update():
        opened.page.select_option("select[name=output]", "twist")
    settled(opened)
    opened.page.locator("label", has_text="deg").click()
    check(opened, path, output="twist", scale=180 / np.pi)
    opened.page.fill("[aria-label='Highest speed in r/min']", "1000")
    opened.page.keyboard.press("Enter")
    cursor = opened.page.locator("#magnitude")
    assert cursor.get_attribute("aria-valuemax") == "1000"
    assert float(cursor.get_attribute("aria-valuenow")) <= 1000  # the largest value of all is at 1240
    box = opened.page.locator("#magnitude .u-over").bounding_box()
    opened.page.mouse.dblclick(box["x"] + 0.5 * box["width"], box["y"] + 50)
    opened.until(lambda: float(cursor.get_attribute("aria-valuemax")) > 1499, "the whole range")


@pytest.mark.slow
def test_the_other_axis_and_back(opened, path):
    opened.page.locator("label", has_text="frequency").click()
    opened.until(lambda: opened.page.is_visible("#phase"), "the response")
    opened.until(lambda: opened.text("#command").startswith("torsionnet frf"), "the command")
    assert opened.page.locator("#magnitude").get_attribute("aria-label") == "Frequency cursor"
    assert len(drawn(opened)) == 1
    opened.page.locator("label", has_text=re.compile("^speed$")).click()
    opened.until(lambda: opened.page.is_hidden("#phase"), "the orders")
    settled(opened)
    check(opened, path)
    words = shlex.split(opened.text("#command"))
    assert words[:2] == ["torsionnet", "orders"]


@pytest.mark.slow
def test_reload_keeps_the_axis_and_the_zoom(opened):
    opened.page.fill("[aria-label='Highest speed in r/min']", "1100")
    opened.page.keyboard.press("Enter")
    opened.until(lambda: "rpm=300+1100" in opened.page.evaluate("location.hash"), "the address")
    opened.page.reload()
    opened.until(lambda: opened.updates, "the page again")
    settled(opened)
    assert opened.page.locator("#magnitude").get_attribute("aria-valuemax") == "1100"
    assert opened.page.is_hidden("#phase")


@pytest.mark.slow
def test_nothing_to_switch_where_nothing_runs(chromium):
    with serving("dmf_rig") as server, visit(chromium, server.address + "#over=speed", viewport=WIDE) as found:
        assert found.page.get_by_role("group", name="Over").count() == 0
        assert found.page.is_visible("#phase")
        assert found.console == []


@pytest.mark.slow
@pytest.mark.parametrize("width", [pytest.param(1440, marks=pytest.mark.slow), 400])
def test_nothing_sticks_out(chromium, fan, width):
    with visit(chromium, fan.address, viewport={"width": width, "height": 850}) as found:
        assert found.page.evaluate("document.documentElement.scrollWidth") <= width


@pytest.mark.slow
def test_every_control_has_a_name(opened):
    groups = opened.page.locator("fieldset").all()
    assert {"Over", "Angle", "Speed [r/min]"} <= {
        one.locator("legend").inner_text() for one in groups if one.is_visible()
    }


@pytest.mark.slow
def test_time_of_an_update(opened):
    """From the event of the slider to the drawn curves, as the page measures it."""
    opened.page.locator(".parameter:not(.is-derived) .slider").first.focus()
    times = []
    for _ in range(30):
        before = opened.updates
        opened.page.keyboard.press("ArrowRight")
        opened.until(lambda before=before: opened.updates > before, "an update")
        times.append(opened.page.evaluate("torsionnet.lastUpdate"))
    print(f"median {np.median(times):.0f} ms, slowest of 30 {max(times):.0f} ms")  # noqa: T201 (with -s)
    assert np.median(times) < SLOW


LIMITS = "() => torsionnet.drawn().filter(({ isLimit }) => isLimit).map(({ name, magnitude, dash }) => ({ name, magnitude, dash }))"
REDDISH = """
(ranges) => {
  const canvas = document.querySelector("#magnitude canvas");
  const [outer, inner] = [canvas, document.querySelector("#magnitude .u-over")].map((one) => one.getBoundingClientRect());
  const row = Math.round((inner.top + 0.9 * inner.height - outer.top) * devicePixelRatio);
  const { data } = canvas.getContext("2d").getImageData(0, row, canvas.width, 1);
  return ranges.map((range) => {
    const [low, high] = range.map((share) => Math.round((inner.left + share * inner.width - outer.left) * devicePixelRatio));
    const seen = [...Array(high - low).keys()].map((k) => 4 * (low + k));
    return seen.filter((k) => data[k + 3] > 0 && data[k] > data[k + 2] + 5).length / seen.length;
  });
}
"""
"""Shares of red pixels in ranges of the width of the plot, near its lower end; read once, as browsers advise."""


@pytest.fixture(scope="module")
def ship():
    with serving("bulk_carrier", over_speed=["stress(int_shaft)"]) as server:
        yield server


@pytest.mark.slow
@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_limits_and_barred_ranges(chromium, ship, scheme):
    """Data of the command, a band where it bars speeds, and both in words."""
    verdicts = tn.load("bulk_carrier").check_limits().verdicts
    spans = [span for one in verdicts for span in one.barred]  # of both shafts, which are one band
    rpm = [end * 30 / np.pi for end in (min(span.low for span in spans), max(span.high for span in spans))]
    with visit(chromium, ship.address, viewport=WIDE, color_scheme=scheme) as found:
        settled(found)
        limits = found.page.evaluate(LIMITS)
        assert [one["name"] for one in limits] == ["limit intermediate τ_C", "limit intermediate τ_T"]
        assert limits[0]["magnitude"][0] == pytest.approx(1e-6 * verdicts[0].allowed[0], rel=1e-9)
        assert all(one["dash"] for one in limits)
        low, high = ((end - 30) / 78 for end in rpm)  # shares of the speeds shown, 30 to 108 r/min
        inside, outside = found.page.evaluate(REDDISH, [[low + 0.01, high - 0.01], [high + 0.02, high + 0.1]])
        assert (inside > 0.6, outside < 0.1) == (True, True)
        said = re.search(
            r"barred from (\S+) to (\S+) r/min \(limit intermediate τ_C, limit propeller_shaft τ_C\)",
            found.text("#summary"),
        )
        assert [float(end) for end in said.groups()] == pytest.approx(rpm, rel=1e-3)
        assert re.search(r"limit intermediate τ_C \S+ to \S+ N/mm²", found.text("#summary"))
        assert "torsionnet limits" in found.text("#notes")
        assert "51 r/min, barred range" in found.page.locator("#magnitude").get_attribute("aria-valuetext")
        assert kept_quiet(found, ship)


@pytest.mark.slow
def test_a_limit_far_above_does_not_flatten_the_curves(chromium):
    with (
        serving("marine_medium_speed", over_speed=["stress(int_shaft)"]) as server,
        visit(chromium, server.address, viewport=WIDE) as found,
    ):
        settled(found)
        found.until(lambda: len(found.page.evaluate(LIMITS)) == 2, "the limits")
        assert found.page.evaluate("torsionnet.drawn().filter(({ isFar }) => isFar).length") == 2
        assert re.search(r"limit intermediate τ_C 35\.7\d to 69\.38 N/mm²", found.text("#summary"))
