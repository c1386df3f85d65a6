"""`python -m splitgrain_postpro`."""

import sys

from .cli import main

sys.exit(main())
