"""``python -m ospace.cli``."""

import sys

from ospace.cli.main import main

sys.exit(main())
