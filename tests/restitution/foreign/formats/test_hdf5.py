"""Tracks as pandas and SLEAP store them in HDF5: the same places; what is damaged or could run is refused."""

import pickle
import tracemalloc

import h5py
import numpy as np
import pytest

from restitution.errors import InputError
from restitution.foreign import Settings, read_foreign, read_track

Y = 700.0 - np.linspace(0.0, 200.0, 30) ** 1.1
"""Rows of an image."""
IMAGE = {"frames_per_second": 250.0, "pixel": "0.05 mm", "wall": 700.0, "point": "lowest"}


def pandas_table(group, blocks):
    """A table of pandas' form "table": blocks of columns, their names pickled in text."""
    fields = [("index", "<i8"), *((name, "<f8", (len(labels),)) for name, labels, _ in blocks)]
    table = np.zeros(len(blocks[0][2]), fields)
    table["index"] = np.arange(len(table))
    stored = group.create_dataset("table", data=table)
    for name, labels, values in blocks:
        table[name] = values
        stored.attrs[f"{name}_kind"] = np.bytes_(pickle.dumps(labels, protocol=0))
    stored[...] = table


def deeplabcut(file):
    labels = [("DLC_resnet50", part, axis) for part in ("ball", "rod") for axis in ("x", "y", "likelihood")]
    values = np.c_[0 * Y, Y, 0 * Y + 0.99, 0 * Y, 0 * Y, 0 * Y + 0.99]
    pandas_table(file.create_group("df_with_missing"), [("values_block_0", labels, values)])


def trackpy_frames(file):
    for i, y in enumerate(Y):
        places = [[y, 120.0, 3000.0], [55.5, 220.0, 3000.0]]
        counts = ("values_block_1", ["frame", "particle"], [[i, 0], [i, 1]])
        pandas_table(file.create_group(f"Frame_{i}"), [("values_block_0", ["y", "x", "mass"], places), counts])


def trackpy_fixed(file):
    group = file.create_group("tracks")
    group.attrs["nblocks"] = 2
    group["axis1"] = np.arange(len(Y))
    group["block0_items"], group["block0_values"] = np.array([b"y", b"x", b"mass"]), np.c_[Y, 0 * Y, 0 * Y]
    counts = np.c_[np.arange(len(Y)), 0 * np.arange(len(Y))]
    group["block1_items"], group["block1_values"] = np.array([b"frame", b"particle"]), counts


def sleap(file):
    tracks = np.full((2, 2, 1, len(Y)), np.nan)
    tracks[0, 0, 0], tracks[0, 1, 0], tracks[1, :, 0, :3] = 120.0, Y, 5.0
    file["tracks"], file["track_names"], file["node_names"] = tracks, [b"track_0", b"track_1"], [b"ball"]


FILES = {
    "DeepLabCut": (deeplabcut, {"particle": "ball"}),
    "trackpy, a table a frame": (trackpy_frames, {"particle": 0}),
    "trackpy, fixed": (trackpy_fixed, {}),
    "SLEAP": (sleap, {"particle": "track_0"}),
}


@pytest.mark.parametrize("name", FILES)
def test_the_same_places_come_out_of_every_store(tmp_path, name):
    write, own = FILES[name]
    with h5py.File(tmp_path / "tracks.h5", "w") as file:
        write(file)
    settings = Settings(**{"point": "lowest"} | IMAGE | own)
    found = read_track(read_foreign(tmp_path / "tracks.h5"), settings, None).table
    np.testing.assert_allclose(found.gap_m, 0.05e-3 * (700.0 - Y), atol=1e-15)
    np.testing.assert_allclose(found.time_s, np.arange(len(Y)) / 250.0, atol=1e-15)


class Caller:
    """What a pickle can be made to do."""

    def __reduce__(self):
        return open, ("called", "w")


def hostile_names(file):
    trackpy_frames(file)
    file["Frame_0/table"].attrs["values_block_0_kind"] = np.bytes_(pickle.dumps([Caller()], protocol=0))


def huge(file):
    file.create_dataset("tracks", (10**4, 2, 10**4, 10**4), dtype="f8", chunks=(1, 2, 10, 10))


def elsewhere(file):
    other = [("other.bin", 0, h5py.h5f.UNLIMITED)]
    file.create_dataset("tracks", (2, 2, 1, 3), dtype="f8", external=other)


@pytest.mark.parametrize("write", [hostile_names, huge, elsewhere, lambda file: file.create_group("a")])
def test_what_could_run_or_fill_the_memory_or_is_no_track_is_refused(tmp_path, monkeypatch, write):
    monkeypatch.chdir(tmp_path)
    with h5py.File("tracks.h5", "w") as file:
        write(file)
    with pytest.raises(InputError):
        read_foreign("tracks.h5")
    assert not (tmp_path / "called").exists()


@pytest.mark.parametrize("part", [0.0003, 0.01, 0.3, 0.6, 0.9])
def test_a_store_that_is_cut_off_is_refused(tmp_path, part):
    with h5py.File(tmp_path / "tracks.h5", "w") as file:
        trackpy_frames(file)
    data = (tmp_path / "tracks.h5").read_bytes()
    (tmp_path / "cut.h5").write_bytes(data[: 8 + int(part * len(data))])
    with pytest.raises(InputError):
        read_foreign(tmp_path / "cut.h5")


def of_names(pickled):
    """A table whose names are this pickle."""

    def write(file):
        pandas_table(file.create_group("tracks"), [("values_block_0", ["y", "x"], np.c_[Y, Y])])
        file["tracks/table"].attrs["values_block_0_kind"] = np.void(pickled)

    return write


def laughs():
    """Two names of a few hundred bytes, a text of each longer than any memory."""
    inner = ("a", "b")
    for _ in range(60):
        inner = (inner, inner)
    return pickle.dumps([[inner, "x"], [inner, "y"]], protocol=2)


def zeros(file):
    file.create_dataset("tracks", (1, 2, 1, 2**23), "f8", chunks=(1, 2, 1, 2**16), compression="gzip")


def deflated(file):
    zeros(file)
    file["tracks"][...] = 0.0


@pytest.mark.parametrize(
    "write",
    [of_names(laughs()), of_names(b"]r\xff\xff\xff\x7f."), of_names(b"]p999999999\n."), zeros, deflated],
    ids=["laughs", "a far place of the memo", "the same in text", "zeros", "deflated zeros"],
)  # fmt: skip
def test_small_files_of_much_memory_are_refused_before_it_is_taken(tmp_path, write):
    path = tmp_path / "bomb.h5"
    with h5py.File(path, "w") as file:
        write(file)
    tracemalloc.start()
    try:
        with pytest.raises(InputError, match="bomb"):
            read_foreign(path)
        assert tracemalloc.get_traced_memory()[1] < 5e7
    finally:
        tracemalloc.stop()


@pytest.mark.parametrize("name", [b"time", b"N."])
def test_times_in_the_index_are_a_column(tmp_path, name):
    """As ``frame.set_index("time").to_hdf`` keeps them; N. is the pickle of no name."""
    times = 0.004 * np.arange(len(Y))
    with h5py.File(tmp_path / "a.h5", "w") as file:
        group = file.create_group("track")
        group.attrs["nblocks"] = 1
        group["axis1"] = times
        group["axis1"].attrs["name"] = np.bytes_(name)
        group["block0_items"], group["block0_values"] = np.array([b"height_mm"]), Y[:, None]
    table = read_foreign(tmp_path / "a.h5")
    assert table.header == ["time" if name == b"time" else "index", "height_mm"]
    assert table.units == {"height_mm": "mm"}
    np.testing.assert_allclose([[float(x) for x in cells] for _, cells in table.rows], np.c_[times, Y])
