"""The page of a pattern of some thousand creases in headless Chromium, as JSON: `make bench-page`.

    python tests/bench/page.py [--out OUT.json]

Bytes of the page; milliseconds until the browser has painted and until both pictures are drawn; frames a second, and
the longest frame in milliseconds, while a slider is moved in every frame for three seconds. Twice, as other programs
may be running: "load" is the system's load average before each.
"""

from __future__ import annotations

import argparse
import json
import os
import shutil
import subprocess
import tempfile
from pathlib import Path

import foldcut
from foldcut.exporters import export
from foldcut.samples import sample_path

SCRIPT = Path(__file__).parents[1] / "node" / "page_speed.cjs"
RUNS = 2


def main() -> None:
    """Print what was measured, and write it where asked."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--out", type=Path)
    args = parser.parse_args()
    node, chromium = (shutil.which(name) for name in ("node", "chromium"))
    if node is None or chromium is None:
        parser.error("node and chromium are needed; tests/tools.sh installs them")
    pattern = foldcut.fold(sample_path("square"), "150x100", margin=20, method="paper").require_verified()
    page = export(pattern, ".html")
    runs = []
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "page.html"
        path.write_bytes(page)
        for _ in range(RUNS):
            load = os.getloadavg()[0]
            done = subprocess.run([node, SCRIPT, chromium, path], capture_output=True, text=True, check=True)
            runs.append({"load": load, **json.loads(done.stdout)})
    measured = {
        "creases": pattern.creases.crease_count,
        "faces": len(pattern.creases.faces_vertices),
        "bytes": len(page),
        "runs": runs,
    }
    text = json.dumps(measured, indent=2)
    print(text)
    if args.out:
        args.out.write_text(text + "\n")


if __name__ == "__main__":
    main()
