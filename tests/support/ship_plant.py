"""The ship of the how-to on limits: a direct-drive two-stroke engine, its shafts, and what they bear."""

import re
from pathlib import Path

PAGE = Path(__file__).parents[2] / "docs" / "how_to" / "limits.md"
PAGE_SHIP = re.search(r"```yaml\n(# ship\.yaml\n.*?)```", PAGE.read_text(encoding="utf-8"), re.DOTALL)[1]
SHIP = PAGE_SHIP.replace("step: 0.25 rpm", "step: 1 rpm")
"""The same at fewer speeds: each is solved with the propeller's damping there."""
