"""``python -m foldcut.cli.main``."""

import sys

from foldcut.cli.main import main

sys.exit(main())
