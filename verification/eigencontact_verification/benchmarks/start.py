"""Time around a solution: whole processes of the command line, against the imports alone.

The imports are those that any program would make that reads and draws such results. They are timed in turn with the
commands, in processes of their own; the first process of each, which may find nothing compiled and no file in the
memory of the system, counts apart.
"""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile

from eigencontact_verification.benchmarks.benchmark import Benchmark, Sample, Task, Trial, once
from eigencontact_verification.benchmarks.codes import Code, ours
from eigencontact_verification.reporting.table import Column

__all__ = ["BENCHMARK", "IMPORTS", "METHODS", "measure"]

#: Imported by the process that the commands are compared with.
IMPORTS = "numpy, scipy.fft, h5py, xarray, pydantic, matplotlib"
_COMMANDS = {
    "help": ("--help",),
    "explain hertz": ("explain", "hertz"),
    "run hertz": ("run", "hertz"),
    "run coated-sphere": ("run", "coated-sphere"),
    "run fretting-mode-1": ("run", "fretting-mode-1"),
}
METHODS = ours(f"imports: {IMPORTS}")


def _python(*arguments: str) -> None:
    """Run an interpreter to its end; it may keep what it compiles, as that of any user."""
    environment = {name: value for name, value in os.environ.items() if name != "PYTHONDONTWRITEBYTECODE"}
    subprocess.run([sys.executable, *arguments], check=True, stdout=subprocess.DEVNULL, env=environment)


def measure(_: Code, task: Task) -> Sample:
    """Time one command of the command line."""
    command = _COMMANDS[task.case]
    with tempfile.TemporaryDirectory() as folder:
        where = ("-o", folder, "--overwrite", "--quiet") if command[0] == "run" else ()

        def call() -> None:
            _python("-c", "from eigencontact.cli import main; main()", *command, *where)

        def imports() -> list[float]:
            return once(lambda: _python("-c", f"import {IMPORTS}"))

        return Trial(call=call, judge=lambda _: {}, floors=lambda: {"imports": imports}, always=3).run(task)


BENCHMARK = Benchmark(
    name="start",
    help="commands as whole processes, pictures included, against bare imports",
    measure=measure,
    floors=("imports",),
    methods=METHODS,
    cases=tuple(_COMMANDS),
    columns=(
        Column("command", "case"),
        Column("first [s]", "first_s", ".2f", brief=False),
        Column("again [s]", "again_s", ".2f"),
        Column("fastest [s]", "again_min_s", ".2f"),
        Column("bare imports [s]", "imports_s", ".2f"),
        Column("again / imports", "again_per_imports", ".2f"),
    ),
)
