"""The dimensionless numbers of a case, against those that others state for the same fluid and sphere."""

import pytest

from restitution.cases.numbers import numbers_of
from restitution.cases.reading import read_case

STATED = {"gondret_st100": 110, "gondret_st152_10": 164, "gondret_st192": 212, "gondret_st742": 788}
"""Re in waLBerla's input for its sphere-wall benchmark (inputSphereWallCollision.dat), in whole numbers."""


@pytest.mark.parametrize(("case", "reynolds"), STATED.items())
def test_reynolds_is_that_of_the_published_benchmark(case, reynolds):
    assert numbers_of(read_case(case)).reynolds == pytest.approx(reynolds, abs=1)


def test_stokes_numbers_are_nine_and_two_apart():
    stokes = numbers_of(read_case("gondret_st152_10")).stokes
    assert stokes["st"] == pytest.approx(152, abs=0.5)
    assert stokes["st_d"] == pytest.approx(9 * stokes["st"])
    assert stokes["st_18"] == pytest.approx(stokes["st"] / 2)


def test_at_the_terminal_speed_the_drag_balances_the_excess_weight():
    n = numbers_of(read_case("gondret_st152_10"))
    drag = (
        24 / n.terminal_reynolds * (1 + 0.15 * n.terminal_reynolds**0.687)
    )  # Schiller & Naumann, by hand, near the standard curve
    assert 3 / 4 * drag * n.terminal_reynolds**2 == pytest.approx(n.archimedes, rel=0.05)
