"""Draw the pictures docs/images/explore*.png: the explore page in headless Chromium.

``python docs/explore_picture.py`` needs playwright (dependency group ``test``) and an installed Chromium.
"""

from __future__ import annotations

import contextlib
import sys
import tempfile
from pathlib import Path
from typing import Any

from torsionnet.app.cli import main as torsionnet

DOCS = Path(__file__).parent
sys.path.insert(0, str(DOCS.parent / "tests"))

from support.explore_pages import chromium, serving, visit  # noqa: E402

from torsionnet.app.explore.session import ResponseChoice  # noqa: E402

PICTURE, OVER_SPEED = DOCS / "images" / "explore.png", DOCS / "images" / "explore_speed.png"
POINT = DOCS / "images" / "explore_operating_point.png"
LINE = """torsionnet: 1
name: engine, flywheel in two stages, gear with backlash
elements:
  engine: {type: inertia, node: crank, inertia: 0.15 kg*m^2}
  dmf: {type: spring, nodes: [crank, clutch], damping: 0.5, stages: [{stiffness: 460, to: 0.12 rad}, {stiffness: 1500}]}
  disc: {type: inertia, node: clutch, inertia: 0.05 kg*m^2}
  mesh: {type: gear, nodes: [clutch, wheel], ratio: 4, stiffness: 20 kN*m/rad, damping: 2, backlash: 0.5 deg}
  vehicle: {type: inertia, node: wheel, inertia: 24 kg*m^2}
operating_point: {torque: {crank: 200 N*m, wheel: -800 N*m}}
"""
"""The model on the page about laws of motion, under 200 N m."""
SIZE, TALL = {"width": 1440, "height": 900}, {"width": 1440, "height": 1100}
ESTIMATE = "--input T_T --output theta_1 --preset paper --band 0.5 40"


def write_test_response(folder: Path) -> Path:
    """Path of a file with the response of a virtual test of the rig in fifth gear."""
    record, response = folder / "gear_V.npz", folder / "gear_V.csv"
    torsionnet(["bench", "amt_bench", "-c", "V", "-o", str(record)])
    torsionnet(["estimate", str(record), *ESTIMATE.split(), "--csv", str(response)])
    return response


def _line() -> Path:
    path = Path("line.yaml")
    path.write_text(LINE, encoding="utf-8")
    return path


def hide(found: Any, *panes: str) -> None:
    """Hide panes of the explore page by their buttons, so that the curves have their place."""
    for pane in panes:
        found.page.locator("header button", has_text=pane).first.click()
    found.page.wait_for_timeout(300)


def pin_and_change_oil_damping(found: Any) -> None:
    """Prepare the explore page: one curve pinned, another oil damping, the cursor beside the peak."""
    page = found.page
    page.locator("label", has_text="deg").click()
    page.click("#pin")
    with found.update():
        page.fill("#parameter-c_O", "360")
        page.keyboard.press("Enter")
    box = page.locator("#magnitude .u-over").bounding_box()
    page.mouse.move(box["x"] + 0.64 * box["width"], box["y"] + 0.5 * box["height"])
    page.evaluate("document.activeElement.blur()")
    page.wait_for_timeout(300)


def pin_and_soften_damper(found: Any) -> None:
    """Prepare the explore page: the damper as written pinned, less damping in its film, the cursor beside the peak."""
    page = found.page
    page.click("#pin")
    with found.update():
        page.fill("#parameter-c_dmp", "28")
        page.keyboard.press("Enter")
    box = page.locator("#magnitude .u-over").bounding_box()
    page.mouse.move(box["x"] + 0.45 * box["width"], box["y"] + 0.6 * box["height"])
    page.evaluate("document.activeElement.blur()")
    page.wait_for_timeout(1500)


def pin_and_reduce_torque(found: Any) -> None:
    """Prepare the explore page: the curve of the file pinned, a tenth of its torque."""
    page = found.page
    page.click("#pin")
    with found.update():
        page.locator("[id='parameter-operating_point.torque.crank']").fill("20")
        page.keyboard.press("Enter")
    page.evaluate("document.activeElement.blur()")
    page.wait_for_timeout(300)


def main() -> None:
    from playwright.sync_api import sync_playwright

    with tempfile.TemporaryDirectory() as folder, sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=chromium(), args=["--no-sandbox"])
        overlay = write_test_response(Path(folder))
        with (
            serving("amt_rig", configuration="V", pairs=[ResponseChoice("theta_1", "T_T")], overlay=overlay) as server,
            visit(browser, server.address, viewport=TALL) as found,
        ):
            pin_and_change_oil_damping(found)
            found.page.click("#choosing")
            found.page.wait_for_timeout(300)
            found.page.screenshot(path=str(PICTURE))
        with (
            serving("marine_medium_speed", over_speed=["T_crank"]) as server,
            visit(browser, server.address, viewport=SIZE) as found,
        ):
            hide(found, "Text", "Schematic")
            pin_and_soften_damper(found)
            found.page.click("#choosing")
            found.page.wait_for_timeout(300)
            found.page.screenshot(path=str(OVER_SPEED))
        with (
            contextlib.chdir(folder),  # for a short command at the bottom
            serving(_line()) as server,
            visit(browser, server.address, viewport=SIZE) as found,
        ):
            hide(found, "Schematic")
            pin_and_reduce_torque(found)
            found.page.click("#choosing")
            found.page.wait_for_timeout(300)
            found.page.screenshot(path=str(POINT))
        browser.close()


if __name__ == "__main__":
    main()
