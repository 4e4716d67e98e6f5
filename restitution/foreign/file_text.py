"""The lines of a text file whoever wrote it: UTF-8, UTF-16 of spreadsheets, code pages of Windows."""

from __future__ import annotations

import codecs
import contextlib
import itertools
import re
import unicodedata
from functools import cache

from restitution.errors import Defect, InputError
from restitution.foreign.programs import POSITIONS, TIMES
from restitution.tables.widths import check_widths
from restitution.units import NAMES_BEYOND_ASCII

_BINARY = {
    b"PK\x03\x04": "is an archive, no text; save the table as CSV",
    b"\x89HDF": "is HDF5, no text; export the table as CSV",  # of tracks: :mod:`.formats.hdf5`
    b"PAR1": "is Parquet, no text; save it as CSV: pandas.read_parquet(FILE).to_csv(CSV)",
    **dict.fromkeys(
        (b"ARROW1", b"FEA1"), "is Feather, no text; save it as CSV: pandas.read_feather(FILE).to_csv(CSV)"
    ),
    **dict.fromkeys(
        (b"\x80\x04", b"\x80\x05"), "is a pickle of Python, which is not opened; save the table as CSV"
    ),
    b"SQLite format 3": "is a database, no text; save the table as CSV",
    **dict.fromkeys((b"RDX2", b"RDX3", b"X\n\0"), "is a workspace of R, no text; save the table by write.csv"),
    **dict.fromkeys(
        (
            b"RIFF",
            b"\x1aE\xdf\xa3",
            b"\0\0\0\x14ftyp",
            b"\0\0\0\x18ftyp",
            b"\0\0\0\x1cftyp",
            b"\0\0\0\x20ftyp",
            b"CI\x2c\0",
        ),
        "is a film; track the sphere in it first, with Tracker, TrackMate or trackpy",
    ),
    **dict.fromkeys(
        (b"\x89PNG", b"\xff\xd8\xff", b"II*\0", b"MM\0*", b"GIF8", b"%PDF"),
        "is a picture; its points have to be digitised, with WebPlotDigitizer, or the sphere tracked",
    ),
}
"""How files begin that are no text, and what to do with them."""


WESTERN = "cp1252"
_OTHER_LATIN = ["cp1250", "cp1254", "cp1257", "mac_roman"]
_OTHER_SCRIPTS = ["cp1251", "cp1253", "gb18030", "cp932", "cp949", "big5"]
_BEYOND = re.compile(rb"[\x80-\xff]")
_WORDS = re.compile(rb"[\x80-\xff]{3,}")
_SAMPLE = 2**14
_MARKUP = {"{": "JSON", "<": "XML"}


def text_of(data: bytes, file: str) -> str:
    """The text in the bytes of a file, its lines ending alike; raises :class:`InputError` where there is none."""
    for mark, rule in _BINARY.items():
        if data.startswith(mark):
            raise InputError(Defect(rule, file=file))
    if not data.removeprefix(codecs.BOM_UTF8).strip():
        raise InputError(Defect("is empty", file=file))
    text = _decoded(data, file)
    if "\0" in text:
        row = text[: text.index("\0")].count("\n") + 1
        raise InputError(
            Defect("has a NUL byte: is it a binary file? Export the table as CSV", file=file, row=row)
        )
    return text.replace("\r\n", "\n").replace("\r", "\n")


def lines_of(text: str, file: str) -> list[str]:
    """The lines of a text; raises :class:`InputError` for markup, which is no table, and for lines too wide."""
    if kind := _MARKUP.get(text.lstrip()[:1]):
        raise InputError(Defect(f"is {kind}, no table; export the table as CSV", file=file))
    lines = text.split("\n")
    check_widths(lines, file)
    return lines


def _decoded(data: bytes, file: str) -> str:
    if data.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)):
        try:
            return data.decode("utf-16")
        except UnicodeDecodeError:
            raise InputError(Defect("is not UTF-16 text, as its first bytes say", file=file)) from None
    if (unmarked := _unmarked_utf16(data)) is not None:
        return unmarked
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError:
        return data.decode(_code_page(data), errors="replace")


def _unmarked_utf16(data: bytes) -> str | None:
    """UTF-16 without its mark: most characters have a zero byte, as numbers do, all on one side; else None."""
    sample = data[:_SAMPLE]
    for first, order in ((1, "utf-16-le"), (0, "utf-16-be")):
        high = sample[first::2]
        if len(data) % 2 == 0 and 2 * high.count(0) > len(high) and 0 not in sample[1 - first :: 2]:
            with contextlib.suppress(UnicodeDecodeError):
                return data.decode(order)
    return None


def _code_page(data: bytes) -> str:
    """The code page of a text that is no UTF-8: the one in which most names of times, positions, units are found.

    Where none is, that of western Europe, unless whole words are beyond ASCII.
    """
    beyond = b"\n".join(line for line in data.splitlines() if _BEYOND.search(line))[:_SAMPLE]
    pages = (WESTERN, *_OTHER_LATIN, *_OTHER_SCRIPTS)
    texts = [beyond.decode(page, errors="replace") for page in pages]
    known = [_known_words(text) for text in texts]
    likely = [(page, text) for page, text, n in zip(pages, texts, known, strict=True) if n == max(known) > 0]
    if len({text for _, text in likely}) == 1:
        return likely[0][0]
    in_words = sum(map(len, _WORDS.findall(beyond)))
    if 2 * in_words < len(_BEYOND.findall(beyond)):
        return WESTERN
    from charset_normalizer import from_bytes

    best = from_bytes(beyond, cp_isolation=_OTHER_SCRIPTS).best()
    return WESTERN if best is None else best.encoding


def _known_words(text: str) -> int:
    """How many characters beyond ASCII are in words that name times, positions or units."""
    words = re.findall(r"[^\W\d_]+", unicodedata.normalize("NFKC", text).lower())
    return sum(len(word) for word in words if not word.isascii() and word in _words())


@cache
def _words() -> frozenset[str]:
    names = " ".join((*TIMES, *POSITIONS)).lower().split()
    return frozenset(name for name in (*names, *NAMES_BEYOND_ASCII) if not name.isascii())


def mistaken(name: str) -> list[str]:
    """What a name looks like where its file is in one code page and was read as another: few words tell which."""
    found = []
    pages = () if name.isascii() else (WESTERN, *_OTHER_LATIN, *_OTHER_SCRIPTS)
    for page, other in itertools.permutations(pages, 2):
        with contextlib.suppress(UnicodeEncodeError):
            found.append(name.encode(page).decode(other, errors="replace"))
    return found
