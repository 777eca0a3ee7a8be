"""Entry of ``python -m torsionnet.demo``, which runs all demonstrations."""

import sys

from torsionnet.demo import main

sys.exit(main())
