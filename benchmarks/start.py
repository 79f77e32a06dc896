"""How soon the command line answers: CPU of ``--help``, and the first output of every command.

Against ``python -c "import numpy"``, measured in turn with it:
``.venv/bin/python benchmarks/start.py``.
"""

from __future__ import annotations

import resource
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Sequence
from pathlib import Path

COMMAND = Path(sys.executable).parent / "drake-viapoint"
TIMES = 7

HELP: Sequence[Sequence[str]] = ((), ("--help",), ("learn", "serve", "--help"))
FIRST_OUTPUT: Sequence[Sequence[str]] = (
    ("learn", "serve", "--max-trials", "1", "--out", "RUN"),
    ("learn", "serve", "--robot", "--max-trials", "1", "--out", "RUN"),
    ("learn", "upswing", "--max-trials", "1", "--out", "RUN"),
    ("replay", "DONE", "--html", "x.html"),
    ("extract", "person.c3d"),
    ("demonstrate", "upswing", "--out", "again.c3d"),
    ("scenario", "serve"),
    ("choices", "--persons", "1", "--out", "RUN"),
    ("components", "DONE", "--out", "RUN"),
    ("reproduce", "--only", "upswing", "--out", "RUN"),
    ("doctor",),
)


def cpu(words: Sequence[str | Path]) -> float:
    """CPU time of a process [s]."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run(words, capture_output=True, check=True)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def first_output(words: Sequence[str], folder: Path, number: int) -> float:
    """Time until a command, at a terminal, says something [s]; then it is stopped."""
    named = [word.replace("RUN", f"run{number}").replace("DONE", "done") for word in words]
    # `script` gives it a terminal, as a person has
    line = " ".join([str(COMMAND), *named])
    began = time.perf_counter()
    process = subprocess.Popen(
        ["script", "-qec", line, "/dev/null"],
        cwd=folder,
        stdout=subprocess.PIPE,
        stdin=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
    )
    assert process.stdout is not None
    process.stdout.read(1)
    taken = time.perf_counter() - began
    process.terminate()
    process.communicate()
    return taken


def main() -> None:
    """Measure, and print ratios."""
    numpy = [sys.executable, "-c", "import numpy"]
    for words in HELP:
        pairs = [(cpu([COMMAND, *words]), cpu(numpy)) for _ in range(TIMES)]
        ours = statistics.median(pair[0] for pair in pairs)
        ratio = statistics.median(one / other for one, other in pairs)
        said = " ".join(["drake-viapoint", *words])
        print(f"{said:<34} {ours:.3f} s of CPU, {ratio:.2f} of `import numpy`")
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for words in (
            ("demonstrate", "serve", "--out", "person.c3d"),
            ("learn", "serve", "--out", "done", "--max-trials", "20"),
        ):
            subprocess.run([COMMAND, *words], cwd=folder, capture_output=True, check=False)
        for number, words in enumerate(FIRST_OUTPUT):
            taken = first_output(words, folder, number)
            print(f"{'drake-viapoint ' + words[0]:<28} says something after {taken:.2f} s")


if __name__ == "__main__":
    main()
