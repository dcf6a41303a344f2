"""Refuse to start processes from a line of a script that each new process would run again.

A new process imports the script of its parent. Without ``if __name__ == "__main__":`` it would come to the same line,
where Python stops it; the parent then sees nothing but processes that die.
"""

from __future__ import annotations

import ast
import sys
from pathlib import Path

from eigencontact.errors import EigencontactError

__all__ = ["GUARD", "refuse_unguarded"]

#: Why processes may die when they start, for messages where no line of a script is at fault for certain.
GUARD = 'its script starts it without `if __name__ == "__main__":`'


def refuse_unguarded(call: str) -> None:
    """Refuse a call at the top level of the script of this process, outside of every ``if``.

    Parameters
    ----------
    call : str
        What would start processes, for the message: ``"workers=2"``.

    Raises
    ------
    EigencontactError
        Names the script, the line and the guard.
    """
    main = sys.modules.get("__main__")
    path = getattr(main, "__file__", None)
    frame = sys._getframe()  # noqa: SLF001 - the one way to the line that the script is at
    while frame.f_back is not None and not (frame.f_code.co_name == "<module>" and frame.f_globals is vars(main)):
        frame = frame.f_back
    if path is None or frame.f_globals is not vars(main):
        return  # an interactive session, which new processes cannot import, or a thread
    line = frame.f_lineno
    try:
        statements = ast.parse(Path(path).read_bytes()).body
    except (OSError, ValueError, SyntaxError):
        return
    for statement in statements:
        if statement.lineno <= line <= (statement.end_lineno or 0):
            # any other condition may be a guard as well, so only a call without one is refused
            if not any(isinstance(node, ast.If) and node.lineno <= line <= (node.end_lineno or 0)
                       for node in ast.walk(statement)):  # fmt: skip
                raise EigencontactError(
                    f'{Path(path).name}, line {line} must be below `if __name__ == "__main__":` (got {call} outside '
                    "of it); each new process imports the script and would run this line again"
                )
            return
