"""``python -m torsionnet``."""

import sys

from torsionnet.app.cli import main

if __name__ == "__main__":
    sys.exit(main())
