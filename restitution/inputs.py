"""Files of users, read whole within bounds: a file, no device, of no more bytes than are sensible; JSON and TOML.

Both are read more strictly than their parsers do: keys stand once, numbers are finite and of a sensible length,
nesting ends. Whatever is wrong is one :class:`~restitution.errors.Defect` that names the file.
"""

from __future__ import annotations

import bz2
import gc
import gzip
import io
import json
import lzma
import math
import re
import stat
import tomllib
import zlib
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import cache
from pathlib import Path
from typing import Any

from restitution.errors import Defect, InputError

MOST_TABLE, MOST_JSON, MOST_TOML = 2**28, 2**25, 2**16
"""Bytes of a table or track, of a JSON file, of a TOML file."""
LONGEST_TOML_LINE = 2000
"""Bytes: the time for a key of n parts grows with n squared."""
MOST_DIGITS = 300
"""Of a whole number, so that it is one of floating point as well."""
_CHUNK = 2**20
_AT_LINE = re.compile(r"at line (\d+)")
_MOST_SHOWN = 80
"""Characters of a line in a message."""
_PACKED: dict[bytes, Callable[[io.BytesIO], Any]] = {
    b"\x1f\x8b": gzip.open, b"BZh": bz2.open, b"\xfd7zXZ\x00": lzma.open,
}  # fmt: skip


def read_bytes(path: str | Path, most: int = MOST_TABLE) -> bytes:
    """The content of a file or pipe; raises :class:`InputError` where there is none, or more than ``most`` bytes.

    A pipe can be emptied once only, so what came out of one is kept for those that ask again.
    """
    if not str(path):
        raise InputError("a file's name is empty")
    try:
        about = Path(path).stat()
        if stat.S_ISFIFO(about.st_mode):
            return _emptied(str(path), about.st_ino, most)
        if stat.S_ISREG(about.st_mode):
            return _read(path, most)
    except FileNotFoundError:
        raise InputError(Defect("does not exist", file=str(path))) from None
    except OSError as error:
        raise InputError(Defect(f"cannot be read: {error.strerror}", file=str(path))) from None
    except ValueError as error:  # a NUL in the name
        if isinstance(error, InputError):
            raise
        raise InputError(Defect(f"cannot be read: {error}", file=str(path))) from None
    what = "a folder" if stat.S_ISDIR(about.st_mode) else "a device or socket"
    raise InputError(Defect(f"is {what}; a file is needed", file=str(path)))


@cache
def _emptied(path: str, _which: int, most: int) -> bytes:
    return _read(path, most)


def _read(path: str | Path, most: int) -> bytes:
    parts, size = [], 0
    with Path(path).open("rb") as stream:
        while size <= most and (part := stream.read(min(_CHUNK, most + 1 - size))):
            parts.append(part)
            size += len(part)
    if size > most:
        rule = f"is larger than {_size(most)}, the most that is read of such a file"
        raise InputError(Defect(rule, file=str(path)))
    return _unpacked(b"".join(parts), most, str(path))


def _unpacked(data: bytes, most: int, file: str) -> bytes:
    """What is packed in gzip, bzip2 or xz, as solvers keep long tables, within the same bound; else the data."""
    opener = next((opener for mark, opener in _PACKED.items() if data.startswith(mark)), None)
    if opener is None:
        return data
    try:
        with opener(io.BytesIO(data)) as stream:
            content = stream.read(most + 1)
    except (OSError, EOFError, lzma.LZMAError, zlib.error):
        raise InputError(Defect("is packed, and cannot be unpacked: is it whole?", file=file)) from None
    if len(content) > most:
        raise InputError(
            Defect(f"is larger than {_size(most)} unpacked, the most that is read of such a file", file=file)
        )
    return content


@contextmanager
def lists_only() -> Iterator[None]:
    """While rows of cells are made: nothing else, so that the search for unreachable circles is put off.

    Each of its searches looks at every list that there is, and a table has a million.
    """
    on = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if on:
            gc.enable()


def read_json(path: str | Path) -> Any:
    """What a JSON file says; raises :class:`InputError` where it is none, or says anything twice."""
    return json_of(read_bytes(path, MOST_JSON), str(path))


def json_of(content: bytes, file: str) -> Any:
    """What the bytes of a JSON file say; raises :class:`InputError` as :func:`read_json` does."""
    try:
        return json.loads(
            content, parse_int=_integer, parse_float=_number, parse_constant=_number, object_pairs_hook=_once
        )
    except RecursionError:
        raise InputError(Defect("is not JSON that is read here: nested too deep", file=file)) from None
    except ValueError as error:
        raise InputError(Defect(f"is not JSON: {error}", file=file)) from None


def read_toml(path: str | Path) -> dict[str, Any]:
    """The content of a TOML file; raises :class:`InputError` where it cannot be read as such."""
    content, file = read_bytes(path, MOST_TOML), str(path)
    for row, line in enumerate(content.splitlines(), 1):
        if len(line) > LONGEST_TOML_LINE:
            rule = f"is a line of {len(line)} bytes; at most {LONGEST_TOML_LINE} are read"
            raise InputError(Defect(rule, file=file, row=row))
    try:
        text = content.decode("utf-8-sig").replace("\r\n", "\n")
        return tomllib.loads(text)
    except UnicodeDecodeError as error:
        raise InputError(Defect(f"is not UTF-8 text: {error.reason} at byte {error.start}", file=file)) from None
    except RecursionError:
        raise InputError(Defect("is not TOML that is read here: nested too deep", file=file)) from None
    except ValueError as error:  # of which tomllib's own is one
        raise InputError(Defect(f"is not TOML: {error}{_shown(text, str(error))}", file=file)) from None


def _shown(text: str, error: str) -> str:
    """The line of a TOML file that an error of its parser is about, and what the parser means by it."""
    at, lines = _AT_LINE.search(error), text.rstrip().split("\n")
    line = lines[min(int(at[1]), len(lines)) - 1 if at else -1].strip()
    twice = ", a key that stands twice" if error.startswith("Cannot ") else ""
    return f": {line[:_MOST_SHOWN]}{twice}" if line else ""


def _once(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    found: dict[str, Any] = {}
    for key, value in pairs:
        if key in found:
            raise ValueError(f"the key {key!r} stands twice in one object")
        found[key] = value
    return found


def _integer(text: str) -> int:
    if len(text) > MOST_DIGITS:
        raise ValueError(f"a number of {len(text)} digits")
    return int(text)


def _number(text: str) -> float:
    value = float(text)
    if not math.isfinite(value):
        raise ValueError(f"{text} is no finite number")
    return value


def _size(count: int) -> str:
    return f"{count // 2**20} MiB" if count >= 2**20 else f"{count // 2**10} KiB"
