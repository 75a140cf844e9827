"""``python -m foldcut.cli`` is the command ``foldcut``."""

import sys

from foldcut.cli.main import main

sys.exit(main())
