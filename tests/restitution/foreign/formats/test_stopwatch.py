"""Times of one experiment side by side."""

from restitution.foreign.formats.stopwatch import bounces


def test_times_of_flight_side_by_side_are_those_between_contacts():
    """They fall from bounce to bounce, as times of contact cannot."""
    names, rows = bounces(["Time 1 (s)", "Time 2 (s)", "Time 3 (s)"], [(2, ["0.18", "0.13", "0.10"])], "f.csv")
    assert names == ["bounce", "time (s)"]
    assert [float(cells[1]) for _, cells in rows] == [0.0, 0.18, 0.31, 0.41]
    _, rows = bounces(["Time 1 (s)", "Time 2 (s)"], [(2, ["0.18", "0.31"])], "f.csv")
    assert [cells[1] for _, cells in rows] == ["0.18", "0.31"]
