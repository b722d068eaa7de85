"""The command line: `torsade demo`, `torsade run PROTOCOL`. Errors are one sentence and exit code 2."""

from __future__ import annotations

import atexit
import errno
import gc
import io
import os
import sys
from collections.abc import Sequence

from torsade.cli.messages import say
from torsade.errors import TorsadeError, quoted, reason_of
from torsade.stopping import exit_code, sigterm_stops

__all__ = ["main"]

BAD_INPUT = 2

MOST_WORDS = 1000
"""On a command line: finding out what each of very many is takes minutes."""


def main(arguments: Sequence[str] | None = None) -> None:
    """Run the command line and exit."""
    # The collector would go through all that was imported and compiled once more: half a second for nothing.
    atexit.register(gc.freeze)
    # A file's name need not be text, nor every terminal know every letter.
    if isinstance(sys.stdout, io.TextIOWrapper) and sys.stdout.errors == "strict":
        sys.stdout.reconfigure(errors="backslashreplace")
    with sigterm_stops():
        code = _status(sys.argv[1:] if arguments is None else list(arguments))
    sys.exit(code)


def _status(arguments: list[str]) -> int:
    """Exit code of a command line; anything the user should know has been printed."""
    try:
        if len(arguments) > MOST_WORDS:
            raise TorsadeError(
                f"the command line has {len(arguments)} words, more than {MOST_WORDS}; quote what belongs "
                "together, or put fields into a TOML file"
            )
        from cyclopts import CycloptsError

        from torsade.cli.app import build, with_protocol
        from torsade.cli.messages import parse_error

        arguments = with_protocol(arguments)
        app = build(arguments)
        try:
            code = app(arguments, exit_on_error=False, print_error=False, result_action="return_value")
        except CycloptsError as error:
            raise TorsadeError(parse_error(error, arguments)) from None
        sys.stdout.flush()
        return code if isinstance(code, int) else 0
    except TorsadeError as error:
        say(str(error))
        return BAD_INPUT
    except KeyboardInterrupt as error:
        say(str(error) or "interrupted before the first frame; nothing is saved")
        return exit_code()
    except BrokenPipeError:
        # Whoever read the output has had enough, as in `torsade run ... | head`.
        _silence()
        return 1
    except OSError as error:
        if error.errno == errno.ENAMETOOLONG:
            say(f"{quoted(str(error.filename))} is too long for the name of a file; give a shorter one")
            return BAD_INPUT
        if error.filename is not None:
            raise  # of a file that somebody should have looked after
        _silence()
        say(f"cannot write the output ({reason_of(error)}); make room, or write it elsewhere")
        return BAD_INPUT


def _silence() -> None:
    """Nothing more is written to the standard output, neither what waits to be."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
