"""``python -m torsionnet.demo``."""

import sys

from torsionnet.demo import main

sys.exit(main())
