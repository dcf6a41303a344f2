"""Process that draws pictures and loads matplotlib while the run computes.

The process reads what to draw as one line of JSON and answers with one; it ends when the run does, however that ends.
Where it may fork it draws on all cores.
"""

from __future__ import annotations

import gc
import json
import os
import signal
import subprocess
import sys
from contextlib import nullcontext
from io import BytesIO
from pathlib import Path
from typing import TYPE_CHECKING, Any, Self

from eigencontact.core.memory import largest_child_bytes, peak_bytes, resident_bytes
from eigencontact.core.parallel import available_threads
from eigencontact.errors import ResultsError

if TYPE_CHECKING:
    from contextlib import AbstractContextManager

__all__ = ["Painter", "painter_of"]

#: Libraries that would start threads, with which a process must not fork.
_ONE_THREAD = dict.fromkeys(("OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "OMP_NUM_THREADS"), "1")


def painter_of(threads: int | None, *, pictures: bool) -> AbstractContextManager[Painter | None]:
    """Process for the pictures of a run; None if the run draws none or no processor core is free.

    The arguments are ``numerics.threads`` and ``output.pictures`` of the scene.
    """
    no_core = available_threads() < 2 or threads == 1 or not sys.executable
    return nullcontext() if no_core or not pictures else Painter()


class Painter:
    """Process that draws the pictures of one run; use it in a ``with`` block.

    Attributes
    ----------
    peak_bytes : int
        Memory that it has taken at most, once all is drawn: what its copies on other cores share with it counts once.
    """

    def __init__(self) -> None:
        self.peak_bytes = 0
        # -P: a file of the working folder must not pass for a library.
        command = [sys.executable, "-P", "-m", __name__]
        pipe = subprocess.PIPE
        self._process = subprocess.Popen(command, stdin=pipe, stdout=pipe, text=True, env={**os.environ, **_ONE_THREAD})

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self._process.kill()
        self._process.communicate()

    def begin(self, results: Path, folder: Path, *, solid: bool) -> None:
        """Begin to draw; see `eigencontact.viz.figures.draw_all`."""
        order = {"results": str(results.resolve()), "folder": str(folder.resolve()), "solid": solid}
        try:
            self._process.stdin.write(json.dumps(order) + "\n")  # type: ignore[union-attr]
            self._process.stdin.flush()  # type: ignore[union-attr]
        except OSError:  # it has died: `finish` finds no answer
            return

    def finish(self) -> dict[str, str] | None:
        """Wait for the file names and descriptions of all pictures; None if the process failed.

        Raises
        ------
        ResultsError
            When a picture cannot be stored.
        """
        answer = self._process.stdout.readline()  # type: ignore[union-attr]
        if not answer:
            return None
        outcome = json.loads(answer)
        if "refused" in outcome:
            raise ResultsError(outcome["refused"])
        self.peak_bytes = int(outcome["peak_bytes"])
        files: dict[str, str] = outcome["files"]
        return files


def main() -> None:
    """Run as a process: load the libraries, wait for a request, perform it."""
    from eigencontact.results.stored import open_stored
    from eigencontact.viz.figures import draw_all

    gc.disable()  # see draw_all, which collects after each picture
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # the run says when it ends, also when it is interrupted
    _warm_up()
    gc.freeze()  # what is loaded stays
    line = sys.stdin.readline()
    if not line:
        return
    order = json.loads(line)

    def draw(share: tuple[int, int]) -> dict[str, str]:
        with open_stored(order["results"]) as dataset:
            return draw_all(dataset, Path(order["folder"]), solid=order["solid"], share=share)

    try:
        files, copies = _on_all_cores(draw)
        answer: dict[str, Any] = {"files": files, "peak_bytes": peak_bytes() + copies}
    except ResultsError as problem:
        answer = {"refused": str(problem)}
    sys.stdout.write(json.dumps(answer) + "\n")
    sys.stdout.flush()


def _warm_up() -> None:
    """Load h5py, fonts and the modules of matplotlib's first drawing."""
    import h5py  # type: ignore[import-not-found,import-untyped,unused-ignore]  # noqa: F401

    from eigencontact.viz.style import new_figure, paper_style

    with paper_style():
        figure = new_figure(1.0, 1.0)
        figure.add_subplot().set_title(r"$\sigma_{xx}$ [µm]")
        figure.savefig(BytesIO(), format="png", dpi=20)


def _on_all_cores(draw: Any) -> tuple[dict[str, str], float]:
    """Draw share (k, n) in each of n processes; this process draws or refuses the shares that fail.

    Also the memory that the others have taken beyond what they share with this one [bytes].
    """
    before = resident_bytes()
    count = available_threads() if hasattr(os, "fork") and sys.platform != "darwin" else 1
    children = []
    for k in range(1, count):
        child = os.fork()
        if child == 0:
            failed = 1
            try:
                draw((k, count))
                failed = 0
            finally:
                os._exit(failed)
        children.append((k, child))
    files: dict[str, str] = draw((0, count))
    for k, child in children:
        if os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) != 0:
            draw((k, count))
    return files, sum(max(0.0, largest_child_bytes() - before) for _ in children)


if __name__ == "__main__":
    main()
