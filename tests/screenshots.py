"""Take the pictures of the page and of foldcut serve in docs/ anew: `make screenshots`; needs node and chromium."""

from __future__ import annotations

import subprocess
import sys
import tempfile
from pathlib import Path

from PIL import Image
from support.places import ROOT
from support.programs import NODE_FOLDER

import foldcut
from foldcut.exporters import export
from foldcut.samples import sample_path

DOCS = ROOT / "docs"
PORT = "8731"
COLOURS = 160
"""Few, so that the files are small."""


def main() -> None:
    """Take both pictures, with few colours."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        page = folder / "star.html"
        page.write_bytes(export(foldcut.fold(sample_path("star")).require_verified(), ".html"))
        command = [sys.executable, "-m", "foldcut.cli", "serve", "--port", PORT]
        with subprocess.Popen(command, stdout=subprocess.PIPE) as server:
            assert server.stdout is not None
            server.stdout.readline()
            address = f"http://127.0.0.1:{PORT}/"
            node = ["node", NODE_FOLDER / "screenshots.cjs", "/usr/bin/chromium", page, address, folder]
            try:
                subprocess.run(list(map(str, node)), check=True)
            finally:
                server.terminate()
        for picture in ("page.png", "serve.png"):
            small = Image.open(folder / picture).convert("RGB").quantize(COLOURS, dither=Image.Dither.NONE)
            small.save(DOCS / picture, optimize=True)
            print(f"docs/{picture}: {(DOCS / picture).stat().st_size:,} bytes")


if __name__ == "__main__":
    main()
