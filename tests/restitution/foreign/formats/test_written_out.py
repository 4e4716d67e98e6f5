"""What is written out as text before it is read: arrays of NumPy and MATLAB."""

import contextlib

import h5py
import numpy as np
import pytest
from scipy.io import savemat

from restitution.errors import InputError
from restitution.foreign import read_foreign

TIMES, HEIGHTS = [0.0, 0.002, 0.004, 0.006], [5.0, 4.25, 2.5, 3.125]
ROWS = list(zip(TIMES, HEIGHTS, strict=True))


@pytest.mark.parametrize("words", [0, 512])
def test_arrays_in_hdf5(tmp_path, words):
    """MATLAB 7.3 keeps a row as a column and begins with words of its own."""
    with h5py.File(tmp_path / "a.mat", "w", userblock_size=words) as file:
        file["t"], file["y"], file["fps"] = [TIMES], [HEIGHTS], [[500.0]]
    if words:
        with (tmp_path / "a.mat").open("r+b") as file:
            file.write(b"MATLAB 7.3 MAT-file")
    table = read_foreign(tmp_path / "a.mat")
    assert table.header == ["t", "y"]
    assert [[float(cell) for cell in cells] for _, cells in table.rows] == [list(row) for row in ROWS]


def test_an_array_of_numpy(tmp_path):
    np.save(tmp_path / "rows.npy", np.array(ROWS))
    np.save(tmp_path / "columns.npy", np.array([*ROWS, *ROWS]).T)
    for name, frames in (("rows.npy", 4), ("columns.npy", 8)):
        table = read_foreign(tmp_path / name)
        assert (table.header, len(table.rows), table.named) == (["1", "2"], frames, False)
    np.save(tmp_path / "one.npy", np.arange(3.0))
    with pytest.raises(InputError, match="array of 3"):
        read_foreign(tmp_path / "one.npy")


def test_several_arrays_of_numpy(tmp_path):
    np.savez(tmp_path / "a.npz", t=TIMES, xy=np.array([HEIGHTS, HEIGHTS]), fps=500.0, note="x")
    table = read_foreign(tmp_path / "a.npz")
    assert table.header == ["t", "xy_1", "xy_2"]
    assert [[float(cells[0]), float(cells[2])] for _, cells in table.rows] == [list(row) for row in ROWS]
    np.savez(tmp_path / "b.npz", fps=np.array([500.0]))
    with pytest.raises(InputError, match="fps"):
        read_foreign(tmp_path / "b.npz")
    np.savez(tmp_path / "c.npz", t=np.array([{}], dtype=object), y=np.array(HEIGHTS))
    with pytest.raises(InputError, match="numbers alone"):
        read_foreign(tmp_path / "c.npz")
    data = (tmp_path / "a.npz").read_bytes()
    for at in range(0, len(data), len(data) // 40):
        (tmp_path / "a.npz").write_bytes(data[:at] + data[at + 11 :])
        with contextlib.suppress(InputError):
            read_foreign(tmp_path / "a.npz")
    np.savez_compressed(tmp_path / "d.npz", t=np.zeros(2**26))
    with pytest.raises(InputError, match="larger"):
        read_foreign(tmp_path / "d.npz")


def test_a_workspace_of_matlab(tmp_path):
    savemat(tmp_path / "a.mat", {"t": TIMES, "xy": np.array([[1.0] * 4, HEIGHTS]), "fps": 500.0, "note": "x"})
    table = read_foreign(tmp_path / "a.mat")
    assert table.header == ["t", "xy_1", "xy_2"]
    assert [float(cells[2]) for _, cells in table.rows] == HEIGHTS
    savemat(tmp_path / "b.mat", {"fps": 500.0})
    with pytest.raises(InputError, match="fps"):
        read_foreign(tmp_path / "b.mat")
    (tmp_path / "c.mat").write_bytes((tmp_path / "a.mat").read_bytes()[:200])
    with pytest.raises(InputError, match="MATLAB"):
        read_foreign(tmp_path / "c.mat")


def test_tracks_of_u_track(tmp_path):
    """Eight numbers a frame; the track begins in the third frame and has a gap."""
    numbers = np.zeros((1, 32))
    numbers[0, 1::8] = [5.0, np.nan, 2.5, 3.125]
    kind = [("tracksCoordAmpCG", "O"), ("seqOfEvents", "O")]
    events = np.array([[3.0, 1, 1, np.nan], [6.0, 2, 1, np.nan]])
    savemat(tmp_path / "u.mat", {"tracksFinal": np.array([(numbers, events)], dtype=kind)})
    table = read_foreign(tmp_path / "u.mat")
    assert table.header == ["track", "frame", "x", "y"]
    assert [cells[1] for _, cells in table.rows] == ["3", "4", "5", "6"]
    assert [cells[3] for _, cells in table.rows] == ["5.0", "nan", "2.5", "3.125"]


def test_units_in_brackets_are_no_json(tmp_path):
    (tmp_path / "track.csv").write_text("[s],[mm]\n" + "".join(f"{t},{y}\n" for t, y in ROWS))
    assert len(read_foreign(tmp_path / "track.csv").rows) == len(ROWS)


def test_a_damaged_array_is_an_error_of_the_input(tmp_path):
    np.save(tmp_path / "a.npy", np.array(ROWS))
    data = (tmp_path / "a.npy").read_bytes()
    for at in range(6, 100):
        (tmp_path / "a.npy").write_bytes(data[:at] + b"(" + data[at + 1 :])
        with contextlib.suppress(InputError):
            read_foreign(tmp_path / "a.npy")
