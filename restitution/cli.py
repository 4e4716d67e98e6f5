"""The command line: declares the subcommands, turns what is wrong with the input into one line and status 2."""

from __future__ import annotations

import argparse
import os
import sys
import warnings
from collections.abc import Sequence

from restitution import __version__
from restitution.commands import (
    bounce,
    calibrate_solver,
    cases,
    compare,
    data,
    design,
    export,
    fit,
    impacts,
    laws,
    look,
    predict,
    report,
    simulate,
    sweep,
    validate,
)
from restitution.commands.parser import Parser
from restitution.errors import Defect, InputError, OutOfRangeWarning, first_of, printable


def build_parser() -> argparse.ArgumentParser:
    """The parser of the whole command line."""
    parser = Parser(
        prog="restitution",
        description="Reference toolkit for wet rebound: laws, measured data, impacts, calibration, reports.",
    )
    parser.add_argument("--version", action="version", version=f"restitution {__version__}")
    commands = parser.add_subparsers(dest="command", required=True, metavar="COMMAND")
    for module in (
        data,
        laws,
        impacts,
        look,
        fit,
        compare,
        predict,
        design,
        export,
        cases,
        simulate,
        bounce,
        sweep,
        calibrate_solver,
        report,
        validate,
    ):
        module.add_parser(commands)
    return parser


def main(argv: Sequence[str] | None = None) -> int:
    """Run one command; returns the exit status: 0, or 2 for input that cannot be used."""
    args = build_parser().parse_args(argv)
    with warnings.catch_warnings():
        warnings.simplefilter("always", OutOfRangeWarning)
        warnings.showwarning = _show_warning
        return _run(args)


def _run(args: argparse.Namespace) -> int:
    try:
        _check_threads()
        status = args.run(args) or 0
        if sys.stdout is not None:
            sys.stdout.flush()
        return status
    except InputError as error:
        for defect in first_of(error.defects):
            print(f"error: {defect}", file=sys.stderr)  # noqa: T201
        return 2
    except BrokenPipeError:
        sys.stderr.close()  # the reader left (`| head`): no message about flushing
        return 0
    except OSError as error:
        # Files are read and written with their own errors; what is left is a name that is none, or the output.
        if error.filename is not None:
            print(f"error: {Defect(str(error.strerror), file=str(error.filename))}", file=sys.stderr)  # noqa: T201
            return 2
        print(f"error: the output cannot be written: {error.strerror or error}", file=sys.stderr)  # noqa: T201
        sys.stdout = None  # nothing more to flush at exit
        return 2
    except KeyboardInterrupt:
        print("interrupted", file=sys.stderr)  # noqa: T201
        return 130


def _check_threads() -> None:
    """Refuse a number of threads that numba would stop at, wherever it is imported first."""
    given = os.environ.get("NUMBA_NUM_THREADS")
    if given is not None and not (given.strip().isdecimal() and int(given) > 0):
        raise InputError(Defect("must be a positive number of threads", field="NUMBA_NUM_THREADS", value=given))


def _show_warning(message: Warning | str, *_: object) -> None:
    print(f"warning: {printable(str(message))}", file=sys.stderr)  # noqa: T201
