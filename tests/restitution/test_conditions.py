"""What is wrong with a user's file, in words about the file: which field, which value, what it must be."""

import pytest

from restitution.cases.reading import read_case
from restitution.conditions import read_conditions
from restitution.errors import InputError

FLUID = "[fluid]\ndensity = 935\nviscosity = 0.01\n"
SPHERE = "[sphere]\ndiameter = 0.003\ndensity = 7800\ne_dry = 0.97\n"


def defects(error):
    return [(d.field, d.value, d.rule) for d in error.defects]


@pytest.mark.parametrize(
    ("text", "field", "value", "words"),
    [
        (FLUID + SPHERE.replace("0.97", "1.4"), "sphere.e_dry", "1.4", "must be 1 or below"),
        (FLUID + SPHERE.replace("0.97", "nan"), "sphere.e_dry", "nan", "must be a finite number"),
        (FLUID + SPHERE.replace("0.97", "inf"), "sphere.e_dry", "inf", "must be a finite number"),
        (FLUID + SPHERE.replace("7800", "true"), "sphere.density", "True", "must be a number"),
        (FLUID + SPHERE.replace("0.003", "[1, 2]"), "sphere.diameter", None, "must be a number"),
        (FLUID + SPHERE + "source = 3\n", "sphere.source", "3", "is not a known key"),
        ("source = 3\n" + FLUID + SPHERE, "source", "3", "must be a text"),
        ("fluid = 3\n" + SPHERE, "fluid", "3", "must be a table of keys, as in [fluid]"),
        (FLUID, "sphere", None, "is missing"),
    ],
)
def test_conditions_that_cannot_be_are_said_in_plain_words(tmp_path, text, field, value, words):
    path = tmp_path / "mine.toml"
    path.write_text(text)
    with pytest.raises(InputError) as found:
        read_conditions(path)
    assert defects(found.value) == [(field, value, words)]


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ('[numerics]\ncells_per_diameter = "ten"', [("numerics.cells_per_diameter", "ten", "must be a number")]),
        ('[numerics]\nprecision = "half"', [("numerics.precision", "half", "must be 'float32' or 'float64'")]),
        ('[release]\nkind = "drop"\ngap_d = 1.0', [("release.kind", "drop", "must be 'rest' or 'drive'")]),
        # Of a key that is one of two things, the one that was meant.
        (
            '[contact]\nmode = "effective"\nmeasured = [0.8, "x", 2]',
            [("contact.measured.1", "x", "must be a number"), ("contact.measured.2", "2", "must be 1 or below")],
        ),
    ],
)
def test_a_case_that_cannot_be_is_said_in_plain_words(tmp_path, text, expected):
    path = tmp_path / "mine.toml"
    path.write_text(f'base = "gondret_st152_10"\n{text}\n')
    with pytest.raises(InputError) as found:
        read_case(path)
    assert defects(found.value) == expected
