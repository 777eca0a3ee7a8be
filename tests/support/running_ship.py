"""The bulk carrier of the library at few speeds, with a misfire of each cylinder in turn and of each alone."""

from pathlib import Path

SHIP = Path(__file__).parents[2] / "library" / "bulk_carrier.yaml"
CASES = {f"only_{number}": f"misfire of cylinder {number}" for number in range(1, 7)}


def misfiring():
    """Text of the model with these configurations."""
    own = "misfire: {engine.misfire: [2]}}"
    alone = "".join(f", {name}: {{engine.misfire: [{number}]}}" for number, name in enumerate(CASES, 1))
    text = SHIP.read_text("utf-8")
    assert text.count(own) == text.count("step: 0.25 rpm") == 1
    return text.replace(own, f"each: {{engine.misfire: each}}{alone}}}").replace("step: 0.25 rpm", "step: 3 rpm")
