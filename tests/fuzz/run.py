"""Fuzz a reader, guided by coverage: ``python tests/fuzz/run.py READER [--seconds 300] [--out out/fuzz]``.

Needs atheris (extra ``fuzz``). An input that breaks a promise is written to the folder, one file for each place in the
code where that happens, and the run continues. The last line says how many inputs were tried, how many branches they
reached, and what was found. The branches of foldcut and of the Python libraries behind its readers guide the fuzzer;
compiled libraries are called, but do not guide it.
What reached new branches is kept in ``out/fuzz/READER-inputs``: the next run goes on from there, so
that a long run can be made of many parts. ``--input FILE`` tries one file, without atheris.
"""

from __future__ import annotations

import argparse
import hashlib
import re
import resource
import subprocess
import sys
import tempfile
import time
import traceback
from pathlib import Path

HERE = Path(__file__).resolve()
sys.path.insert(0, str(HERE.parent.parent))

LONGEST_S = 10.0
"""The longest processor time for one input, in seconds."""

MEMORY_MB = 1024
"""The most memory that a run may take."""

MAX_BYTES = 8192
"""The size of the largest input."""

GUIDING = ["foldcut", "svgelements", "ezdxf", "fontTools", "defusedxml", "PIL", "json", "pypdfium2"]
"""The packages whose branches guide the fuzzer."""


def fuzz(reader: str, corpus: Path, out: Path, seconds: int) -> None:
    """Fuzz in this process, which ends when time is up or when an input kills it."""
    import atheris

    with atheris.instrument_imports(include=GUIDING):
        from fuzz.targets import TARGETS

        target = TARGETS[reader]
        for seed in target.seeds:  # readers and their libraries are imported where they are used
            target.check(seed)

    def one_input(data: bytes) -> None:
        started = time.process_time()
        try:
            target.check(data)
        except BaseException as error:
            if isinstance(error, KeyboardInterrupt):
                raise
            _keep(out, data, _place(error), traceback.format_exc())
        if (used := time.process_time() - started) > LONGEST_S:
            _keep(out, data, "slow", f"{used:.1f} s of processor time\n")

    def mutated(data: bytes, largest: int, seed: int) -> bytes:
        return target.mended(atheris.Mutate(data, largest))[:largest]

    options = [
        f"-max_total_time={seconds}", f"-max_len={MAX_BYTES}", f"-rss_limit_mb={MEMORY_MB}", "-timeout=60",
        f"-artifact_prefix={out}/", "-report_slow_units=60", str(corpus),
    ]  # fmt: skip
    words = HERE.parent / "words" / f"{reader}.dict"
    if words.exists():
        options.insert(0, f"-dict={words}")
    atheris.Setup([sys.argv[0], *options], one_input, custom_mutator=mutated)
    atheris.Fuzz()


def _place(error: BaseException) -> str:
    """Return where an error comes from, as the name of a file."""
    frames = traceback.extract_tb(error.__traceback__)
    last = [f"{Path(frame.filename).stem}.{frame.name}.{frame.lineno}" for frame in frames[-2:]]
    return re.sub(r"[^\w.]+", "_", "-".join([type(error).__name__, *last]))[:120]


def _keep(out: Path, data: bytes, name: str, said: str) -> None:
    """Keep the shortest input for each place."""
    file = out / name
    if not file.exists() or len(data) < file.stat().st_size:
        file.write_bytes(data)
        file.with_name(f"{name}.txt").write_text(said)


def supervise(reader: str, out: Path, seconds: int) -> tuple[str, bool]:
    """Fuzz in processes of their own, a new one if an input kills one; return a line, and whether all is well."""
    from fuzz.targets import TARGETS

    out.mkdir(parents=True, exist_ok=True)
    tried, branches, peak_mb, killed = 0, 0, 0, 0
    end = time.monotonic() + seconds
    corpus = out.with_name(f"{out.name}-inputs")  # kept, so that a run goes on where the one before ended
    corpus.mkdir(exist_ok=True)
    with tempfile.TemporaryDirectory() as folder:
        log = Path(folder, "log")
        for seed in TARGETS[reader].seeds:
            (corpus / hashlib.sha1(seed).hexdigest()).write_bytes(seed)
        while (left := round(end - time.monotonic())) > 0:
            before = set(out.iterdir())
            command = [sys.executable, str(HERE), reader, "--seconds", str(left), "--out", str(out)]
            with log.open("wb") as file:
                done = subprocess.run([*command, "--corpus", str(corpus)], stdout=file, stderr=file, check=False)
            text = log.read_text(errors="replace")
            tried += last_number(r"#(\d+)\s.*cov:", text)
            branches = max(branches, last_number(r"cov: (\d+)", text))
            peak_mb = max(peak_mb, last_number(r"rss: (\d+)Mb", text))
            if done.returncode:
                killed += 1
                (out / f"killed-{killed}.txt").write_text(text[-20_000:])
                if "cov: " not in text:
                    return f"{reader}: atheris did not start; see {out}/killed-{killed}.txt", False
                for artifact in set(out.iterdir()) - before:  # else it would end the next run, too
                    (corpus / hashlib.sha1(artifact.read_bytes()).hexdigest()).unlink(missing_ok=True)
    found = sorted(file.name for file in out.iterdir() if file.suffix != ".txt")
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    line = (
        f"{reader}: {tried:,} inputs in {seconds} s, {used.ru_utime + used.ru_stime:.0f} s of processor time, "
        f"{branches:,} branches, at most {peak_mb} MB, killed {killed} times, {len(found)} findings {' '.join(found)}"
    )
    return line.rstrip(), not found and not killed


def last_number(pattern: str, text: str) -> int:
    """Return the last of the numbers that atheris printed, 0 without any."""
    return int(([0, *re.findall(pattern, text)])[-1])


def main() -> int:
    """Run, and return 1 if something was found."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("reader")
    parser.add_argument("--seconds", type=int, default=300)
    parser.add_argument("--out", type=Path, default=Path("out", "fuzz"))
    parser.add_argument("--input", type=Path, help="try this file only")
    parser.add_argument("--corpus", type=Path, help=argparse.SUPPRESS)
    args = parser.parse_args()
    if args.corpus:
        fuzz(args.reader, args.corpus, args.out, args.seconds)
        return 0
    from fuzz.targets import TARGETS

    if args.reader not in TARGETS:
        parser.error(f"there is no reader {args.reader}; give one of {', '.join(TARGETS)}")
    if args.input:
        print("taken" if TARGETS[args.reader].check(args.input.read_bytes()) else "refused")
        return 0
    line, is_well = supervise(args.reader, args.out / args.reader, args.seconds)
    print(line)
    return int(not is_well)


if __name__ == "__main__":
    sys.exit(main())
