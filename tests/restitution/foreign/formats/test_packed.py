"""Files that are packed, as solvers keep long tables: read as what is in them, within the same bounds."""

import bz2
import gzip
import lzma

import pytest

from restitution.errors import InputError
from restitution.foreign import read_foreign
from restitution.inputs import read_bytes

TEXT = b"# iter t z\n0 0.0 0.5\n100 0.1 0.4\n200 0.2 0.3\n"


@pytest.mark.parametrize("pack", [gzip.compress, bz2.compress, lzma.compress])
def test_what_is_packed_is_read(tmp_path, pack):
    path = tmp_path / "yade.txt.packed"
    path.write_bytes(pack(TEXT))
    table = read_foreign(path)
    assert (table.header, table.rows[1][1]) == (["iter", "t", "z"], ["100", "0.1", "0.4"])


@pytest.mark.parametrize("pack", [gzip.compress, bz2.compress, lzma.compress])
def test_what_is_cut_short_is_refused_in_one_line(tmp_path, pack):
    path = tmp_path / "cut.gz"
    path.write_bytes(pack(bytes(range(256)) * 20)[:40])
    with pytest.raises(InputError, match="whole"):
        read_foreign(path)


def test_the_bound_is_that_of_what_is_inside(tmp_path):
    path = tmp_path / "bomb.gz"
    path.write_bytes(gzip.compress(bytes(10**6)))
    with pytest.raises(InputError, match="unpacked"):
        read_bytes(path, 10**5)
