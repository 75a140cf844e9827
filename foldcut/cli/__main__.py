"""``python -m foldcut.cli`` is the command ``foldcut``."""

import sys

from foldcut.cli.start import main

sys.exit(main())
