"""Peak memory of this process over a baseline, read from the kernel.

``resource.getrusage`` is no use here: on Linux a child inherits ``ru_maxrss`` across fork and exec, so a small solve
started from a large process reports the parent's peak. The high-water mark of ``/proc/self/status`` belongs to this
address space alone and can be reset.
"""

from __future__ import annotations

import gc
from pathlib import Path

__all__ = ["PeakMemory"]

_STATUS = Path("/proc/self/status")
_CLEAR = Path("/proc/self/clear_refs")


def _field(name: str) -> int | None:
    """Value of one line of the status file [byte], or None where the system has no such file."""
    try:
        lines = _STATUS.read_text().splitlines()
    except OSError:
        return None
    values = [line.split()[1] for line in lines if line.startswith(f"{name}:")]
    return 1024 * int(values[0]) if values else None


class PeakMemory:
    """Peak resident memory since this object was made, over the resident memory at that moment.

    Examples
    --------
    >>> memory = PeakMemory()
    >>> (memory.peak() or 0) >= 0
    True
    """

    def __init__(self) -> None:
        gc.collect()
        try:
            _CLEAR.write_text("5")  # resets the high-water mark to what is resident now
            self.reset = True
        except OSError:
            self.reset = False
        self.baseline = _field("VmRSS")

    def peak(self) -> int | None:
        """Growth of the peak [byte]; None where the system does not tell.

        Where the mark cannot be reset it is that of the whole process: too large by what imports had freed again.
        """
        mark = _field("VmHWM")
        return None if mark is None or self.baseline is None else max(0, mark - self.baseline)
