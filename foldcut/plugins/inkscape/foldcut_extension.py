"""What Inkscape calls: it hands its document to foldcut and prints the crease pattern, which takes its place."""

import os
import subprocess
import sys
import tempfile

PROGRAM = ["foldcut"]
"""How foldcut is called; ``foldcut inkscape-extension`` writes here where it is installed."""


def command(arguments: list[str], output: str) -> list[str]:
    """Return how foldcut is called: Inkscape gives its options, an --id for all that is selected, and a file."""
    *given, drawing = arguments
    words = [word for word in given if not word.endswith("=") and not word.startswith("--what")]
    return [*PROGRAM, "make", drawing, "--from", "svg", "--quiet", "-o", output, *words]


def main() -> int:
    """Run foldcut; whatever it says is an error, which Inkscape shows."""
    with tempfile.TemporaryDirectory() as folder:
        output = os.path.join(folder, "pattern.svg")
        # Inkscape has a Python of its own, and foldcut must not see its modules
        own = {name: value for name, value in os.environ.items() if not name.startswith("PYTHON")}
        try:
            done = subprocess.run(command(sys.argv[1:], output), env=own, check=False)
        except OSError as error:
            print(f"{PROGRAM[0]}: {error.strerror}; run foldcut inkscape-extension again", file=sys.stderr)
            return 1
        if done.returncode:
            return done.returncode
        with open(output, "rb") as file:
            sys.stdout.buffer.write(file.read())
    return 0


if __name__ == "__main__":
    sys.exit(main())
