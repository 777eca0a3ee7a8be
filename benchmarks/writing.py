"""Processor time of the server for a keystroke in the text pane, and times from it to faults, schematic and response.

The first is told beside an eigenvalue problem of the size of the model's, the latter beside the commands for them. For
them the server of the page runs in a process of its own. Another client asks it for responses over speed all the time,
as a page does while a slider moves; each keystroke is one digit of a stiffness.
"""

import itertools
import json
import re
import statistics
import subprocess
import sys
import tempfile
import threading
import time
import urllib.request
from contextlib import contextmanager
from pathlib import Path

import numpy as np

import torsionnet as tn
from benchmarks._sizes import sized

ROOT = Path(__file__).parents[1]
sys.path.append(str(ROOT / "tests"))

from support.explore_texts import Page  # noqa: E402

GOALS = {"two_stroke_ship": (80, 150, 200), "200 nodes": (400, 400, 400)}
"""Model -> goals in ms for faults, schematic with modes, and response, as 95th percentiles."""
WHAT = ("faults", "schematic and modes", "response")
KEYSTROKES, RUNS, STROKES = sized(40, 3), sized(5, 1), sized(30, 2)


def chain(nodes=200):
    """Text of a model of that many discs on shafts, one line for each element."""
    lines = ["torsionnet: 1", f"name: chain of {nodes} discs", "elements:"]
    for k in range(nodes):
        lines.append(f"  disc_{k}: {{type: inertia, node: n{k}, inertia: {1 + k % 7} kg*m^2}}")
        if k:
            ends = f"nodes: [n{k - 1}, n{k}]"
            lines.append(
                f"  shaft_{k}: {{type: spring, {ends}, stiffness: {1 + k % 5}00 kN*m/rad, damping: 20 N*m*s/rad}}"
            )
    return "\n".join([*lines, "inputs: {T: {torque: n0}}", "sensors: {theta: {angle: n9}}", ""])


@contextmanager
def page(path):
    """Address of a page of that model, served by a process of its own."""
    command = [sys.executable, "-m", "torsionnet", "explore", str(path), "--no-browser"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True, cwd=ROOT) as server:
        try:
            yield server.stdout.readline().strip()
        finally:
            server.terminate()


def asked(address, question, **entries):
    """Answer of the page's server, a JSON object."""
    request = urllib.request.Request(
        f"{address}api/{question}", json.dumps(entries).encode(), {"Content-Type": "application/json"}
    )
    with urllib.request.urlopen(request) as answer:
        return json.load(answer)


def keystrokes(text):
    """Texts that differ in one digit of the first stiffness from one to the next."""
    found = re.search(r"\n +\w+: [^\n]*?(?:value|stiffness): (\d)", text)
    assert found is not None
    for digit in itertools.cycle("123456789"):
        yield text[: found.start(1)] + digit + text[found.end(1) :]


def measured(path):
    """Times in ms of all keystrokes, to faults, to schematic with modes, and to the response."""
    with page(path) as address:
        opened = asked(address, "open", document="bench")
        state = asked(address, "model", document="bench")["start"]
        stop = threading.Event()

        def busy():
            while not stop.is_set():
                asked(address, "answer", document="bench", kind="other", **state)

        other = threading.Thread(target=busy, daemon=True)
        other.start()
        times = []
        for revision, text in zip(range(1, KEYSTROKES + 1), keystrokes(opened["text"]), strict=False):
            began = time.perf_counter()
            found = asked(address, "text", document="bench", revision=opened["revision"] + revision, text=text)
            assert found["sound"], found
            faults = time.perf_counter()
            asked(address, "schematic", document="bench", **state)
            asked(address, "motion", document="bench", **state)
            picture = time.perf_counter()
            asked(address, "answer", document="bench", **state)
            times.append([1000 * (at - began) for at in (faults, picture, time.perf_counter())])
            time.sleep(0.05)
        stop.set()
        other.join()
    return times[1:]  # the first one loads what the others find loaded


def processor_times(path):
    """Processor time in ms by question that the page asks after a keystroke, the median of some, and how many nodes."""
    page = Page.of(path)

    def ask(question, **entries):
        began = time.process_time()
        answer = page.ask(question, **entries)
        return answer, 1000 * (time.process_time() - began)

    opened, described = ask("open")[0], ask("model")[0]
    state, found = described["start"], {}
    for revision, text in zip(range(1, STROKES + 2), keystrokes(opened["text"]), strict=False):
        # The outline stays where digits alone change; over speed all speeds are asked for once it is quiet.
        asked = [("text", {"revision": opened["revision"] + revision, "text": text})]
        asked += [("answer", {**state, "rough": True}), ("schematic", state), ("motion", state)]
        asked += [("answer", state)] if state["axis"] == "speed" else []
        for number, (question, entries) in enumerate(asked):
            answer, took = ask(question, **entries)
            assert "refused" not in answer, answer
            found.setdefault(f"{question} at rest" if number > 3 else question, []).append(took)
    return {question: statistics.median(times[1:]) for question, times in found.items()}, opened["text"].count(
        "inertia:"
    )


def of_eigenvalues(nodes):
    """Processor time in ms of numpy's eigenvalues and vectors of a full matrix with two states a node."""
    matrix = np.random.default_rng(0).normal(size=(2 * nodes, 2 * nodes))
    began = time.process_time()
    np.linalg.eig(matrix)
    return 1000 * (time.process_time() - began)


def of_all_modes(nodes):
    """Processor time in ms of all modes of a damped chain of so many nodes, with descriptions and shares."""
    times = []
    for text in itertools.islice(keystrokes(chain(nodes)), 5):
        rig = tn.loads(text)
        assert rig.assembly.system.n_coordinates == nodes  # made before the clock runs
        began = time.process_time()
        rig.modes()
        times.append(1000 * (time.process_time() - began))
    return statistics.median(times)


def command(*words):
    """Time in ms of a command that tells the same, once for each saved file."""
    began = time.perf_counter()
    words = [sys.executable, "-m", "torsionnet", *map(str, words)]
    subprocess.run(words, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, cwd=ROOT, check=True)
    return 1000 * (time.perf_counter() - began)


def main():
    with tempfile.TemporaryDirectory() as folder:
        ship, line = Path(folder) / "two_stroke_ship.yaml", Path(folder) / "chain.yaml"
        ship.write_text((ROOT / "library" / "two_stroke_ship.yaml").read_text("utf-8"), "utf-8")
        line.write_text(chain(), "utf-8")
        large = Path(folder) / "large.yaml"
        large.write_text(chain(sized(1000, 150)), "utf-8")
        for path in (ship, ROOT / "library" / "reciprocating_compressor_train.yaml", line, large):
            times, nodes = processor_times(path)
            whole, alone = sum(times.values()), of_eigenvalues(nodes)
            parts = ", ".join(f"{question} {took:.0f}" for question, took in times.items())
            ratio = f"{whole / alone:.3g} times eig of {2 * nodes} states ({alone:.0f} ms)"
            print(f"{path.stem}: {whole:.0f} ms of the processor a keystroke, {ratio}: {parts}")
        nodes = sized(200, 50)
        whole, alone = of_all_modes(nodes), statistics.median(of_eigenvalues(nodes) for _ in range(5))
        print(f"all modes of {nodes} damped nodes: {whole:.0f} ms, {whole / alone:.3g} times eig of {2 * nodes} states")
        for (name, goals), path in zip(GOALS.items(), (ship, line), strict=True):
            times = measured(path)
            for what, goal, column in zip(WHAT, goals, zip(*times, strict=True), strict=True):
                ordered = sorted(column)
                late = ordered[min(int(0.95 * len(ordered)), len(ordered) - 1)]
                verdict = "reached" if late <= goal else "missed"
                half = statistics.median(ordered)
                print(f"{name}: to {what} {half:.0f} ms, 95th percentile {late:.0f} ms (goal {goal}: {verdict})")
            for what in ("check", "modes"):
                took = statistics.median(command(what, path) for _ in range(RUNS))
                print(f"{name}: torsionnet {what} on the saved file {took:.0f} ms")


if __name__ == "__main__":
    main()
