"""``python -m ospace``."""

import sys

from ospace.cli.main import main

sys.exit(main())
