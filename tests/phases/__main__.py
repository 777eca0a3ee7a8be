"""All phases of ``.ci/run``."""

from __future__ import annotations

import sys

from phases.running import Phase, Run, make

# A browser and LaTeX open what the package writes; where they can be had, no test may be left out for want of them.
PACKAGES = "chromium gcc poppler-utils lmodern texlive-latex-recommended texlive-latex-extra texlive-science"
INSTALL = f"""
if [ "$(id -u)" = 0 ] && command -v apt-get >/dev/null; then
    apt-get -o Acquire::http::Timeout=60 update -qq && DEBIAN_FRONTEND=noninteractive apt-get install -y -qq {PACKAGES} >/dev/null && exit
fi
echo "no browser and LaTeX from packages here: tests that need them may be skipped"
exit 3
"""
TOOLS = Phase("tools", ("bash", "-c", INSTALL), brings_tools=True)
SET_UP = Phase("set-up", ("make", *(f".venv/.group-{group}" for group in ("test", "lint", "docs"))), 90)

STEPS = (
    ((TOOLS,), (make("clean", 0), SET_UP)),
    # Each of them keeps one core busy.
    ((make("lint", 20), make("types", 150), make("wheel", 30)), (make("docs", 190), make("demo", 20))),
    ((make("test", 400, "ARGS=--most-of-one=10", name="quick tests"),),),
    ((make("test-kernel", 250, "ARGS=--cases-of-each=1", name="second BLAS kernel"),),),
    ((make("test-slow", 850, name="slow tests"),),),
)
WHOLE = 2000.0

if __name__ == "__main__":
    sys.exit(Run("phases of .ci/run", WHOLE).carry_out(STEPS))
