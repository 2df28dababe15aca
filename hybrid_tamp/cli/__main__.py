"""``python -m hybrid_tamp.cli``."""

import sys

from hybrid_tamp.cli import main

sys.exit(main())
