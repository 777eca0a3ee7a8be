"""Writing a model in the explore page, by keyboard and mouse in headless Chromium; skipped where there is none."""

import re
import time
from contextlib import contextmanager
from pathlib import Path

import numpy as np
import pytest
from support.editor_pages import README_MODEL, Writing, ready, serving_text, writing_on
from support.explore_pages import Visit

import torsionnet as tn

MODES_OF_README = "80.87"
"""Hz; the page shows five digits of the 80.8702 that the README prints."""

BROKEN = {
    "no unit of inertia": ("inertia: 0.078 kg*m^2", "inertia: 0.078 kg*m", "is not a value of inertia", "write 0.078 kg*m^2"),
    "no element type": ("type: spring", "type: sprng", 'did you mean "spring"', 'write "spring"'),
    "no parameter": ("stiffness: k_1", "stiffness: k_2", 'did you mean "k_1"', 'write "k_1"'),
    "no key": ("stiffness:", "stifness:", 'did you mean "stiffness"', 'write "stiffness"'),
    "brace not closed": ("ratio: tau}", "ratio: tau", "is not closed", "close with }"),
    "bracket not closed": ("nodes: [a, b]", "nodes: [a, b", 'closing "]" is missing', "close with ]"),
    "name twice": ("  load:  {", "  motor: {", "already given at line 5", ""),
    "decimal comma": ("0.078 kg", "0,078 kg", "has a decimal comma", "write a decimal point"),
    "no element": ("torque: shaft", "torque: shft", 'did you mean "shaft"', 'write "shaft"'),
    "tab": ("  shaft: {", "\tshaft: {", "a tab stands here", "indent with spaces"),
    "no number": ("ratio: tau", "ratio: 3:1", 'expected a number, got "3:1"', "write 3.0"),
}  # fmt: skip

SCRIPT = (
    "t", "take", "motor and load", "Tab", "k_1:13.3 k", "take", "Enter", "tau:4.14", "Tab",
    "motor:i", "take", "a", "Tab", "0.078 k", "take", "Enter",
    "shaft:s", "take", "k", "take", ", d", "take", "z", "take", "0.02", "Tab", "60", "Enter",
    "stage:g", "take", "t", "take", "Enter", "load:i", "take", "2.6 k", "take", "Tab",
    "T_M:t", "take", "Tab", "T_S:t", "take",
)  # fmt: skip
"""What is typed into an empty pane, and keys; "take" is Enter once completion offers a word that goes on with this."""
MOST_KEYS = 120

TABLE = "station\tJ [kg*m^2]\tk [MN*m/rad]\nCyl 1\t100\t50\nCyl 2\t100\t40\nFlywheel\t900\t\n"


@contextmanager
def visit_faulty(chromium, server):
    """A page whose text is faulty from the start, which draws no curve yet."""
    with chromium.new() as page:
        found = Writing(Visit(page))
        page.goto(server.address)
        found.until(lambda: page.evaluate("Boolean(globalThis.torsionnet?.text)"), "the text")
        yield found


@pytest.fixture
def file(tmp_path):
    path = tmp_path / "model.yaml"
    path.write_text(README_MODEL)
    return path


@pytest.fixture
def writing(chromium, file):
    with serving_text(file) as server, writing_on(chromium, server) as found:
        yield found


def natural_frequencies(writing):
    return writing.page.locator("#modes tbody td.natural").all_inner_texts()


def test_fault_is_shown_and_mended_while_the_last_results_stay(writing):
    assert MODES_OF_README in natural_frequencies(writing)
    writing.exchange("stiffness: k_1", "stiffness: k_2")
    (fault,) = writing.faults()
    assert fault.startswith("6:51")
    assert '"k_2"' in fault
    assert writing.page.is_visible("#stale")
    assert MODES_OF_README in natural_frequencies(writing)
    writing.keys.press("Control+.")
    assert writing.faults() == []
    assert writing.text == README_MODEL
    assert writing.page.is_hidden("#stale")


@pytest.mark.slow
def test_readme_model_is_written_from_an_empty_pane_in_few_keystrokes(writing):
    """Completion brings sections, elements with the nodes that come next, and units; Tab goes from gap to gap."""
    keys, page = writing.keys, writing.page
    writing.put("")
    for part in SCRIPT:
        if part == "take":
            writing.until(lambda: page.locator("[role=option][aria-selected]").count(), f"an offer in {writing.text}")
            time.sleep(0.1)  # a list that has only just come up takes no key yet, lest it catch one meant for the text
            keys.press("Enter")
        elif part in ("Enter", "Tab"):
            keys.press(part)
        else:
            keys.type(part)
    assert writing.faults() == []
    built, expected = tn.loads(writing.text), tn.loads(README_MODEL)
    np.testing.assert_allclose(built.modes().eigenvalues, expected.modes().eigenvalues, rtol=1e-12)
    assert sum(1 if part in ("take", "Enter", "Tab") else len(part) for part in SCRIPT) <= MOST_KEYS


@pytest.mark.slow
def test_faults_of_the_load_follow_the_text_and_all_of_a_kind_are_mended(chromium, file):
    """Where no text was sound yet, the results say what is wrong now; one button mends every fault of a kind."""
    file.write_text(
        README_MODEL.replace("inertia: 0.078 kg*m^2", "inertia: 0.078 kg*m").replace("2.6 kg*m^2", "2.6 kg")
    )
    with serving_text(file) as server, visit_faulty(chromium, server) as page:
        page.page.wait_for_selector("#refused:visible")
        assert page.page.inner_text("#stale") == "The text is faulty: no results yet"
        assert '"2.6 kg"' in page.page.inner_text("#refused")
        page.page.get_by_role("button", name="Mend all 2 of this kind").click()
        page.until(lambda: page.page.is_hidden("#refused"), "results")
        assert page.text == README_MODEL
        page.exchange("0.078", "0,078")
        assert page.page.inner_text("#stale") == "The text is faulty: results of the last sound one"


@pytest.mark.slow
def test_ten_breaks_are_mended_from_their_messages(writing):
    """By the button of the fix where one is offered, else at the place that the message leads to."""
    for name, (old, new, message, fix) in BROKEN.items():
        writing.put(README_MODEL)
        assert writing.faults() == [], name
        broken = README_MODEL.replace(old, new, 1)
        writing.put(broken)
        faults = writing.faults()
        assert any(message in fault for fault in faults), (name, faults)
        fault = writing.page.locator("#fault-list li.error", has_text=message)
        if fix:
            button = fault.get_by_role("button", name=fix)
            button.focus()
            writing.keys.press("Enter")
        else:
            fault.locator(".go").click()
            writing.keys.insert_text("load")
        assert writing.faults() == [], name
        found = tn.loads(writing.text)
        assert len(found.elements) == 4, name
        writing.focus()
        writing.keys.press("Control+z")
        assert writing.checked().text == broken, name


@pytest.mark.slow
def test_everything_is_undone(writing):
    writing.exchange("13.3", "26.6")
    assert MODES_OF_README not in natural_frequencies(writing)
    writing.exchange("motor and load", "another")
    assert writing.page.inner_text("h1") == "another"
    writing.focus()
    for _ in range(2):
        writing.keys.press("Control+z")
    assert writing.checked().text == README_MODEL
    assert MODES_OF_README in natural_frequencies(writing)
    assert not writing.is_title_marked()
    writing.keys.press("Control+y")
    assert "26.6" in writing.checked().text


@pytest.mark.slow
def test_no_character_is_lost_while_results_arrive(writing, file):
    """Keys without a pause, a slider dragged meanwhile, undo across Save, another writer, and a reload."""
    page, keys = writing.page, writing.keys
    digits = "31415926535897932384"
    writing.go_to("13.3")
    keys.type("13.3" + digits, delay=8)
    assert writing.checked().text == README_MODEL.replace("13.3", "13.3" + digits)
    for _ in digits:
        keys.press("Backspace")
    assert writing.checked().text == README_MODEL
    box = page.locator(".parameter .slider").first.bounding_box()
    x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
    page.mouse.move(x, y)
    page.mouse.down()
    writing.focus()
    keys.press("Control+End")
    for k, key in enumerate("# 𝜋 dragged"):
        page.mouse.move(x + 2 * k, y)
        keys.insert_text(key)
    page.mouse.up()
    assert writing.checked().text == README_MODEL + "# 𝜋 dragged"
    keys.press("Control+s")
    writing.until(lambda: writing.said().startswith("Saved"), "the word about it")
    stored = file.read_text(encoding="utf-8")
    assert stored == README_MODEL + "# 𝜋 dragged"
    for _ in range(40):
        keys.press("Control+z")
    assert writing.checked().text == README_MODEL
    assert (writing.is_title_marked(), file.read_text(encoding="utf-8")) == (True, stored)
    for _ in range(40):
        keys.press("Control+y")
    assert writing.checked().text == stored
    keys.type(" mine")
    file.write_text(stored + "# other\n", encoding="utf-8")
    writing.until(lambda: page.locator(".bar").count() == 1, "the bar")
    own = writing.text
    assert own == stored + " mine"
    page.reload()
    ready(writing.found)
    assert (writing.text, writing.is_title_marked()) == (own, True)
    assert file.read_text(encoding="utf-8") == stored + "# other\n"


@pytest.mark.slow
def test_slider_values_are_written_into_the_text(writing):
    writing.page.fill("#parameter-k_1", "26.6")
    writing.keys.press("Enter")
    writing.found.settle()
    expected = tn.loads(README_MODEL).configured(k_1="26.6 kN*m/rad").modes().natural_frequencies[-1]
    assert float(natural_frequencies(writing)[-1]) == pytest.approx(expected, rel=1e-4)
    writing.found.keep("write")
    assert "k_1: 26.6 kN*m/rad" in writing.checked().text
    assert float(natural_frequencies(writing)[-1]) == pytest.approx(expected, rel=1e-4)
    assert writing.page.get_by_role("button", name="Reset all").is_disabled()
    writing.keys.press("Control+z")
    assert writing.checked().text == README_MODEL
    assert MODES_OF_README in natural_frequencies(writing)


@pytest.mark.slow
def test_saving_is_explicit(writing, file):
    writing.exchange("13.3", "15")
    assert writing.is_title_marked()
    assert file.read_text() == README_MODEL
    writing.keys.press("Control+s")
    writing.until(lambda: writing.said().startswith("Saved"), "the word about it")
    assert file.read_text() == README_MODEL.replace("13.3", "15")
    assert not writing.is_title_marked()


@pytest.mark.slow
def test_a_faulty_text_is_saved_as_it_stands(writing, file):
    """By the button and by Ctrl-S, also where a slider was moved before; never the last sound text."""
    writing.page.fill("#parameter-k_1", "26.6")
    writing.keys.press("Enter")
    writing.exchange("stiffness: k_1", "stifness: [k_1")
    writing.page.get_by_role("button", name="Save").click()
    faulty = README_MODEL.replace("stiffness: k_1", "stifness: [k_1")
    writing.until(lambda: file.read_text() == faulty, "the faulty text in the file")
    writing.until(lambda: "Values of sliders are not in the text" in writing.said(), "the word about the slider")
    writing.exchange("name: motor", "name motor")
    writing.keys.press("Control+s")
    writing.until(lambda: "name motor" in file.read_text(), "the text in the file")
    assert file.read_text() == writing.text
    assert [one.name for one in file.parent.iterdir()] == ["model.yaml"]


@pytest.mark.slow
@pytest.mark.parametrize("why", ["template", "library", "read-only", "ended"])
def test_a_text_that_no_file_takes_becomes_a_download(chromium, file, monkeypatch, why):
    sources = {"template": {"text": README_MODEL}, "library": {"path": "dmf_rig"}}
    with serving_text(**sources.get(why, {"path": file})) as server, writing_on(chromium, server) as found:
        found.exchange("name:", "nam:")
        if why == "read-only":  # root may write such files all the same
            monkeypatch.setattr("torsionnet.app.explore.disk_file.os.access", lambda *_: False)
        if why == "ended":
            found.page.route("**/api/**", lambda route: route.abort())
        with found.page.expect_download() as download:
            found.keys.press("Control+s")
        assert download.value.suggested_filename == ("dmf_rig.yaml" if why == "library" else "model.yaml")
        assert Path(download.value.path()).read_text(encoding="utf-8") == found.text
        found.until(lambda: found.said().startswith("Saved as a download"), "the word about it")
        assert found.is_title_marked() == (why in ("read-only", "ended"))
        assert file.read_text() == README_MODEL
        if why == "ended":
            found.found.console.clear()  # the browser tells of the requests without an answer


@pytest.mark.slow
def test_enter_behind_a_number_ends_the_line(writing):
    """Whatever completion has on show: opened by itself, asked for, or open before the number was typed."""
    for number in ("tau: 4.14", "{value: 1", "4.14e", "tau: 1k"):
        writing.put("parameters:\n  k_14: 5\n  k_1: 6\n  ")
        writing.keys.type(number)
        time.sleep(0.3)  # completion that opens by itself would be there
        writing.keys.press("Control+Space")
        time.sleep(0.3)
        writing.keys.press("Enter")
        assert f"\n  {number}\n" in writing.text.replace("}", ""), number
    writing.put("parameters:\n  k_14: 5\n  tau: ")
    writing.keys.press("Control+Space")
    writing.until(lambda: writing.page.locator(".cm-tooltip-autocomplete").count(), "completion")
    writing.keys.type("14")
    time.sleep(0.3)
    writing.keys.press("Enter")
    assert "tau: 14\n" in writing.text


@pytest.mark.slow
def test_two_writers_of_one_file(writing, file):
    file.write_text(README_MODEL.replace("13.3", "14"))
    writing.until(lambda: "14 kN" in writing.text, "the text of the other writer")
    assert not writing.is_title_marked()
    writing.exchange("14 kN", "15 kN")
    file.write_text(README_MODEL.replace("13.3", "16"))
    writing.until(lambda: writing.page.locator(".bar").count() == 1, "the bar")
    assert "15 kN" in writing.text
    writing.keys.press("Control+s")
    dialog = writing.dialog()
    difference = dialog.locator(".difference").inner_text()
    assert re.search(r"^-.*16 kN", difference, re.MULTILINE)
    assert re.search(r"^\+.*15 kN", difference, re.MULTILINE)
    writing.keys.press("Escape")
    writing.until(lambda: writing.page.locator("dialog").count() == 0, "the end of the dialog")
    assert "16 kN" in file.read_text()
    writing.keys.press("Control+s")
    writing.dialog().get_by_role("button", name="Take theirs").click()
    writing.until(lambda: "16 kN" in writing.text, "their text")
    writing.focus()
    writing.keys.press("Control+z")
    assert "15 kN" in writing.text
    file.write_text(README_MODEL.replace("13.3", "17"))
    writing.keys.press("Control+s")
    writing.dialog().get_by_role("button", name="Keep mine").click()
    writing.until(lambda: "15 kN" in file.read_text(), "the stored text")
    writing.until(lambda: not writing.is_title_marked(), "the end of the mark")


@pytest.mark.slow
def test_unsaved_text_survives_a_closed_tab(chromium, file, monkeypatch):
    monkeypatch.setattr("torsionnet.app.explore.document.ALIVE_SECONDS", 0.0)
    with serving_text(file) as server:
        with writing_on(chromium, server) as first:
            first.exchange("13.3", "15")
        with writing_on(chromium, server) as second:
            second.until(lambda: "15 kN" in second.text, "the unsaved text")
            assert second.is_title_marked()
            second.page.get_by_role("button", name="Take the file instead").click()
            second.until(lambda: second.text == README_MODEL, "the text of the file")
        assert file.read_text() == README_MODEL


@pytest.mark.slow
def test_pasted_table_becomes_a_model_with_sliders(writing):
    """A unit that is missing is asked for; a number becomes a parameter by one click, which edits the text."""
    writing.page.context.grant_permissions(["clipboard-read", "clipboard-write"])
    writing.page.evaluate("(text) => navigator.clipboard.writeText(text)", TABLE.replace(" [MN*m/rad]", ""))
    writing.focus()
    writing.keys.press("Control+v")
    writing.dialog().get_by_label("Unit of k").select_option("MN*m/rad")
    writing.page.get_by_role("button", name="Go on").click()
    writing.until(lambda: "Make a model" in writing.dialog().inner_text(), "the second question")
    assert "table of 4 lines" in writing.dialog().inner_text()
    assert '"J [kg*m^2]": inertia' in writing.dialog().inner_text()  # as what each column is understood
    writing.keys.press("Enter")
    assert writing.faults() == []
    inertia, stiffness = np.diag([100.0, 100.0, 900.0]), np.array([[50.0, -50, 0], [-50, 90, -40], [0, -40, 40]]) * 1e6
    expected = np.sqrt(np.linalg.eigvals(np.linalg.solve(inertia, stiffness)).real.clip(0)) / (2 * np.pi)
    shown = [float(text) for text in natural_frequencies(writing)]
    np.testing.assert_allclose(np.sort(shown)[-2:], np.sort(expected)[-2:], rtol=1e-4)
    writing.page.get_by_role("button", name="Slider for inertia of Flywheel").click()
    writing.until(lambda: writing.page.locator("#parameter-J_Flywheel").count(), "the slider")
    assert "  J_Flywheel: 900" in writing.checked().text
    assert "inertia: J_Flywheel" in writing.text
    writing.page.fill("#parameter-J_Flywheel", "450,5")
    writing.keys.press("Enter")
    writing.found.settle()
    assert writing.page.input_value("#parameter-J_Flywheel") == "450.5"
    writing.focus()
    for _ in range(2):
        writing.keys.press("Control+z")
    assert writing.checked().text == README_MODEL


@pytest.mark.slow
def test_tab_within_a_line_and_the_band_of_a_new_text(writing):
    """Tab with nothing left to fill in leaves the line in its section; the band is that of the curve."""
    writing.go_to("node: a")
    writing.keys.press("Tab")
    assert writing.text == README_MODEL
    writing.exchange("0.078", "0.079")
    assert writing.faults() == []
    low, high = (float(field.input_value()) for field in writing.page.locator(".band:visible input").all())
    assert 0 < low < high


@pytest.mark.slow
def test_node_is_renamed_everywhere(writing):
    writing.go_to("node: a")
    writing.keys.press("ArrowRight")
    writing.keys.press("F2")
    dialog = writing.dialog()
    writing.keys.press("Control+a")
    writing.keys.insert_text("not a name")
    writing.keys.press("Enter")
    writing.until(lambda: "not a valid name" in dialog.inner_text(), "the refusal")
    writing.keys.press("Control+a")
    writing.keys.insert_text("crank")
    writing.keys.press("Enter")
    writing.until(lambda: "crank" in writing.text, "the new name")
    assert writing.faults() == []
    assert "nodes: [crank, b]" in writing.text
    assert "{torque: crank}" in writing.text
    assert set(tn.loads(writing.text).nodes) == {"crank", "b", "c"}
    writing.keys.press("Control+z")
    assert writing.checked().text == README_MODEL


@pytest.mark.slow
def test_outline_leads_to_an_element(writing):
    writing.focus()
    writing.keys.press("Control+Shift+o")
    writing.dialog()
    writing.keys.insert_text("stage")
    writing.keys.press("Enter")
    writing.until(lambda: writing.page.locator("dialog").count() == 0, "the end of the dialog")
    writing.keys.insert_text("gears")
    assert "  gears: {type: gear" in writing.checked().text


@pytest.mark.slow
def test_cursor_and_schematic_choose_each_other(writing):
    chosen = "[...document.querySelectorAll('#schematic .is-chosen')].map((one) => one.id).sort().join()"
    writing.go_to("zeta")
    writing.until(lambda: writing.page.evaluate(chosen) == "element-shaft", "the spring in the schematic")
    writing.go_to("[b, c]")
    writing.until(lambda: writing.page.evaluate(chosen) == "element-stage", "the gear")
    writing.keys.press("ArrowLeft")
    writing.keys.press("ArrowRight")
    writing.until(lambda: writing.page.evaluate(chosen) == "element-stage,node-b", "the gear and its node")
    asked = sum(one.endswith("outline") for one in writing.found.requests)
    writing.exchange("0.078", "12.0781")
    assert (
        sum(one.endswith("outline") for one in writing.found.requests) == asked
    )  # digits of a number move places alone
    writing.page.locator("#element-load path").first.click(force=True)
    writing.keys.insert_text("wheel")
    assert "  wheel:  {type: inertia, node: c" in writing.checked().text
    assert sum(one.endswith("outline") for one in writing.found.requests) > asked
    writing.keys.press("Control+z")
    writing.checked()
    writing.page.locator("#schematic [tabindex='0']").focus()
    writing.keys.press("Home")
    names = []
    for _ in range(9):
        names.append(writing.page.evaluate("document.activeElement.id"))
        writing.keys.press("ArrowRight")
    assert {f"element-{name}" for name in ("motor", "shaft", "stage", "load")} <= set(names)
    writing.page.locator("#element-shaft").focus()
    writing.keys.press("Enter")
    writing.keys.insert_text("spindle")
    assert "  spindle: {type: spring" in writing.checked().text


@pytest.mark.slow
def test_mode_swings_on_the_schematic(chromium, file):
    """Amplitudes of the two masses are as their inertias, with the gear between: I_1 phi_1 + I_2/tau phi_2 = 0."""
    angles = "[...document.querySelectorAll('.swinging line')].map((one) => Number(/-?[\\d.]+/.exec(one.getAttribute('transform'))[0]))"
    with serving_text(file) as server, writing_on(chromium, server, reduced_motion="reduce") as found:
        page = found.page
        assert page.locator("#mode option:checked").inner_text().startswith("1: 80.87 Hz")
        assert page.inner_text("#play") == "Play"
        a, b, c = page.evaluate(angles)
        assert a / b == pytest.approx(-2.6 / 4.14**2 / 0.078, rel=1e-2)
        assert b / c == pytest.approx(4.14, rel=1e-2)
        assert "against it" in page.inner_text("#moving")
        page.get_by_role("button", name="Play").click()
        found.until(lambda: abs(page.evaluate(angles)[0] - a) > 5, "motion")
        page.get_by_role("button", name="Pause").click()
        assert page.evaluate(angles) == page.evaluate(angles)


@pytest.mark.slow
def test_panes_by_keyboard(writing):
    writing.focus()
    inside = "(pane) => document.querySelector(pane).contains(document.activeElement)"
    assert writing.page.evaluate(inside, "#text")
    writing.keys.press("Tab")
    assert writing.page.evaluate(inside, "#text")
    writing.keys.press("Control+z")
    writing.keys.press("Escape")
    writing.keys.press("Tab")
    assert not writing.page.evaluate(inside, "#editor")
    writing.focus()
    seen = []
    for _ in range(4):
        writing.keys.press("F6")
        seen.append(
            next(pane for pane in ("#text", "#drawing", "#sheet", "#parameters") if writing.page.evaluate(inside, pane))
        )
    assert set(seen) == {"#text", "#drawing", "#sheet", "#parameters"}
    bar = writing.page.get_by_role("separator", name="Width of the text")
    bar.focus()
    before = writing.page.locator("#text").bounding_box()["width"]
    writing.keys.press("ArrowRight")
    assert writing.page.locator("#text").bounding_box()["width"] == pytest.approx(before + 24, abs=1)
    writing.keys.press("Enter")
    assert writing.page.is_hidden("#text")
    writing.keys.press("Enter")  # on the button that shows it again
    assert writing.page.is_visible("#text")


@pytest.mark.slow
def test_cleared_field_says_what_is_missing(writing):
    field = writing.page.locator("#parameter-k_1")
    field.fill("")
    writing.keys.press("Tab")
    assert "type a number, such as 13.3 kN" in writing.page.inner_text("#parameter-k_1-gap")
    assert field.get_attribute("aria-invalid") is not None
    assert field.get_attribute("aria-describedby") == "parameter-k_1-gap"
    writing.page.get_by_role("button", name="Reset k_1").click()
    assert writing.page.is_hidden("#parameter-k_1-gap")
    assert field.input_value() == "13.3"


@pytest.mark.slow
@pytest.mark.parametrize("width", [1440, 1024, 800])
@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_text_can_be_read_at_any_width(chromium, file, width, scheme):
    with (
        serving_text(file) as server,
        writing_on(chromium, server, viewport={"width": width, "height": 800}, color_scheme=scheme) as found,
    ):
        page = found.page
        if width <= 960:
            page.get_by_role("tab", name="Text").click()
        assert page.locator(".cm-content").bounding_box()["width"] > 215
        assert page.evaluate("document.documentElement.scrollWidth") <= width
        ground, ink = (
            page.evaluate(f"getComputedStyle(document.querySelector('.cm-editor')).{name}")
            for name in ("backgroundColor", "color")
        )
        levels = [sum(int(one) for one in re.findall(r"\d+", colour)[:3]) for colour in (ground, ink)]
        assert (levels[0] < levels[1]) is (scheme == "dark")
        assert abs(levels[0] - levels[1]) > 400


HOSTILE = """torsionnet: 1
name: "<img src=x onerror=window.hit=1><script>window.hit=1</script>"
source: "<iframe src=javascript:parent.hit=1>"
description: "'><svg onload=window.hit=1>"
parameters:
  k: {value: 13.3 kN*m/rad, description: "<img src=x onerror=window.hit=1> [a](javascript:window.hit=1)"}
elements:
  motor: {type: inertia, node: a, inertia: 0.078 kg*m^2, description: "<img src=x onerror=window.hit=1>"}
  shaft: {type: spring, nodes: [a, b], stiffness: k}
  load: {type: inertia, node: b, inertia: 2.6 kg*m^2}
"""


@pytest.mark.slow
def test_texts_of_a_model_are_no_part_of_the_page(writing):
    """Names, descriptions, faults and explanations are shown as they are written, whatever they hold."""
    page = writing.page
    writing.put(HOSTILE)
    assert not [fault for fault in writing.faults() if "turn freely" not in fault]
    assert "<img src=x" in page.inner_text("#name")
    box = page.locator(".cm-line", has_text="k: {value").locator("span").first.bounding_box()
    page.mouse.move(box["x"] + 2, box["y"] + box["height"] / 2)
    writing.until(lambda: page.locator(".cm-tooltip-hover").count(), "the explanation of k")
    assert "<img src=x onerror=window.hit=1> [a](javascript:window.hit=1)" in page.inner_text(".cm-tooltip-hover")
    writing.put(HOSTILE.replace("node: a", 'node: "<img src=x onerror=window.hit=1>"'))
    assert any("<img src=x" in fault for fault in writing.faults())
    foreign = "document.querySelectorAll('body img, body iframe, body script, body a[href^=javascript]').length"
    assert page.evaluate(foreign) == 0
    assert page.evaluate("window.hit === undefined")
