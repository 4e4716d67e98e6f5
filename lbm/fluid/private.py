"""Whether what lies on the disk can only have been put there by this user.

A kept kernel is run as it is read. So a folder is believed where it is this user's, none but they may write to it,
and nobody else can put another in its place: no folder above it is another user's or writable by others, but for
those that have the sticky bit, as /tmp. A file is believed in such a folder where the same holds for itself.
"""

from __future__ import annotations

import os
import stat
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

_OTHERS_WRITE = stat.S_IWGRP | stat.S_IWOTH
_OWN_ALONE = 0o077
"""Mask of what others may do with what is made here: nothing."""


def doubt(place: Path) -> str | None:
    """Why a file or folder that is there may hold what another user wrote; None where it cannot.

    Where the system has no users and modes as POSIX knows them, nothing is doubted.
    """
    if not hasattr(os, "geteuid"):
        return None
    place = place.resolve()
    found, user = place.stat(), os.geteuid()
    if found.st_uid != user:
        return f"{place} belongs to another user"
    if found.st_mode & _OTHERS_WRITE:
        return f"others may write to {place}; chmod go-w mends that"
    administrators = {0, user, Path(place.anchor).stat().st_uid}  # in a container root may go by another number
    for above in place.parents:
        found = above.stat()
        if found.st_uid not in administrators:
            return f"{above} belongs to another user"
        if found.st_mode & _OTHERS_WRITE and not found.st_mode & stat.S_ISVTX:
            return f"others may write to {above}; chmod go-w mends that"
    return None


def make(folder: Path) -> None:
    """Make a folder and those above it that are missing, for this user alone."""
    for place in (*reversed(folder.parents), folder):
        if not place.exists():
            place.mkdir(mode=0o700, exist_ok=True)


@contextmanager
def written_for_this_user() -> Iterator[None]:
    """Within it, files are made so that nobody else can read or write them."""
    usual = os.umask(_OWN_ALONE)
    try:
        yield
    finally:
        os.umask(usual)
