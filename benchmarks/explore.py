"""Times of the explore page: seconds from the command to the first answer, ms from a slider to curves in Chromium."""

import json
import statistics
import subprocess
import sys
import time
import urllib.request
from pathlib import Path

ROOT = Path(__file__).parents[1]
sys.path.append(str(ROOT / "tests"))

from support.explore_pages import Pages, chromium, serving, visit  # noqa: E402

from benchmarks._sizes import sized  # noqa: E402

MODELS = {
    "dmf_rig": ("", 60),
    "amt_rig": ("", 60),
    "six_cylinder_diesel": ("", 60),
    "marine_medium_speed": ("T_crank", 100),
}
"""Model -> output over speed (none: the page over frequency) and goal in ms."""
READY, RUNS, STEPS = 1.0, sized(5, 1), sized(60, 3)
SIZE = {"width": 1440, "height": 900}


def ready():
    """Seconds until the server has given its first answer."""
    began = time.perf_counter()
    command = [sys.executable, "-m", "torsionnet", "explore", "amt_rig", "--no-browser"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True, cwd=ROOT) as server:
        address = server.stdout.readline().strip()
        question = urllib.request.Request(f"{address}api/answer", b"{}", {"Content-Type": "application/json"})
        with urllib.request.urlopen(question) as answer:
            json.load(answer)
        elapsed = time.perf_counter() - began
        server.terminate()
    return elapsed


def updates(pages, model, over_speed):
    """Time in ms of every update while a slider is dragged, as the page measures them."""
    outputs = [over_speed] if over_speed else []
    with serving(model, over_speed=outputs) as server, visit(pages, server.address, viewport=SIZE) as found:
        found.settle()
        box = found.page.locator(".parameter:not(.is-derived) .slider").nth(3).bounding_box()
        x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
        found.page.mouse.move(x, y)
        found.page.mouse.down()
        times = []
        for step in range(1, STEPS + 1):
            before = found.updates
            found.page.mouse.move(x - 0.5 * step, y)
            found.until(lambda before=before: found.updates > before, "an update")
            times.append(found.page.evaluate("torsionnet.lastUpdate"))
        found.page.mouse.up()
    return times


def main():
    ready()  # writes the bytecode that an installed package already has
    seconds = statistics.median(ready() for _ in range(RUNS))
    print(f"ready: {seconds:.2f} s (goal {READY:g}: {'reached' if seconds <= READY else 'missed'})")
    try:
        from playwright.sync_api import sync_playwright
    except ImportError:
        sync_playwright = None
    path = chromium()
    if path is None or sync_playwright is None:
        print("no Chromium or no playwright: updates of the page were not measured")
        return
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=path, args=["--no-sandbox"])
        for model, (over_speed, goal) in MODELS.items():
            times = sorted(updates(Pages(browser), model, over_speed))
            median, late = statistics.median(times), times[int(0.9 * len(times))]
            verdict = "reached" if median <= goal else "missed"
            shown = f"{model} over speed" if over_speed else model
            print(f"{shown}: median {median:.0f} ms, nine of ten within {late:.0f} ms (goal {goal}: {verdict})")
        browser.close()


if __name__ == "__main__":
    main()
