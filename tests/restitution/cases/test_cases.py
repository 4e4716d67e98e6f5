"""Case files: the shipped ones, what they take from records and bases, and bad ones met field by field."""

import re

import pytest

from restitution import cases, datasets
from restitution.cases import ContactModel, FilmModel, Numerics, Release, Span, Study
from restitution.cases.rules import rebound_height_d
from restitution.cli import main
from restitution.conditions import Fluid, Sphere, Wall
from restitution.errors import InputError
from restitution.runs.validity.key import checkpoint_key
from restitution.runs.validity.told import told

GOOD = """
[fluid]
density = 935
viscosity = 0.01
[sphere]
diameter = 0.003
density = 7800
e_dry = 0.97
roughness = 1.5e-7
[release]
kind = "drive"
gap_d = 9
speed = 0.585
ramp = 0.004
[numerics]
cells_per_diameter = 10
[film]
form = "source_abstract_eq3"
[contact]
mode = "dry"
[run]
after_contact = 0.1
"""


def read(tmp_path, text):
    path = tmp_path / "case.toml"
    path.write_text(text)
    return cases.read_case(path)


@pytest.mark.parametrize("name", cases.names())
def test_shipped_cases_can_be_run(name):
    case = cases.read_case(name)
    assert case.title
    assert case.numerics is not None
    if case.record is not None:
        own = datasets.resource(case.record).conditions
        assert (case.fluid, case.gravity) == (own.fluid, own.gravity)


def test_every_measured_trajectory_has_a_case():
    measured = {r.name for r in map(datasets.resource, datasets.names()) if r.kind == "measured"}
    trajectories = {name for name in measured if datasets.resource(name).table == "trajectory"}
    assert trajectories == {cases.read_case(name).record for name in cases.names()} - {None}


def test_a_case_needs_no_numerics(tmp_path):
    case = read(tmp_path, GOOD.replace("[numerics]\ncells_per_diameter = 10\n", ""))
    assert case.numerics is None


def test_stokes_numbers_of_the_predictions_are_those_of_their_names():
    for name, St in (("gondret_st100", 100), ("gondret_st192", 192), ("gondret_st742", 742)):
        c = cases.read_case(name)
        found = c.sphere.density * c.release.speed * c.sphere.diameter / (9 * c.fluid.viscosity)
        assert found == pytest.approx(St, abs=1)


def test_base_and_record_give_way_to_the_case(tmp_path):
    case = read(tmp_path, 'base = "gondret_st152_10"\n[sphere]\ne_dry = 0.9\n[numerics]\nwidth_d = 6.0\n')
    assert (case.sphere.e_dry, case.sphere.diameter) == (0.9, 0.003)
    assert (case.numerics.width_d, case.numerics.cells_per_diameter) == (6.0, 10)


def test_a_section_of_another_kind_replaces_that_of_the_base(tmp_path):
    case = read(tmp_path, 'base = "gondret_st152_10_soft"\n[contact]\nmode = "dry"\n[film]\nfloor = 1e-6\n')
    base = cases.read_case("gondret_st152_10_soft")
    assert case.contact.duration_steps is None
    assert case.film == base.film.model_copy(update={"floor": 1e-6})
    assert cases.read_case("gondret_st152_10_measured").film.tension is None


def test_release_gap_is_the_one_the_record_states():
    case = cases.read_case("li_drop3")
    assert case.release.gap_d * case.sphere.diameter == pytest.approx(15.2e-3, rel=1e-5)


@pytest.mark.parametrize(("density", "viscosity"), [(7800, 0.01), (7800, 1e-7), (945, 0.01)])
def test_height_of_a_rebound_against_weight_and_the_drag_of_stokes(tmp_path, density, viscosity):
    """Step by step: m dv/dt = -(weight less buoyancy) - 3 pi mu d v, m with added mass. Without drag 19.77 mm."""
    case = read(
        tmp_path,
        GOOD.replace("density = 7800", f"density = {density}")
        .replace("viscosity = 0.01", f"viscosity = {viscosity}")
        .replace("height_d", "width_d")
        .replace("cells_per_diameter = 10", "cells_per_diameter = 10\nheight_d = 60"),
    )
    v, height, dt = 0.97 * 0.585, 0.0, 1e-6
    mass, weight, drag = density + 935 / 2, (density - 935) * 9.81, 18 * viscosity / 0.003**2
    while v > 0:
        middle = v - dt / 2 * (weight + drag * v) / mass
        height += dt * middle
        v -= dt * (weight + drag * middle) / mass
    assert rebound_height_d(case) * 0.003 == pytest.approx(height, rel=1e-4)
    if viscosity < 1e-6:
        assert height == pytest.approx(0.01977, rel=1e-3)


BAD = {
    "unknown key": ("gap_d = 9", "gap_d = 9\ngap = 9", "release.gap"),
    "missing key": ("diameter = 0.003", "", "sphere.diameter"),
    "not positive": ("viscosity = 0.01", "viscosity = 0", "fluid.viscosity"),
    "text for a number": ("viscosity = 0.01", 'viscosity = "thin"', "fluid.viscosity"),
    "sphere lighter than the fluid": ("density = 7800", "density = 900", "sphere.density"),
    "sphere in the wall": ("gap_d = 9", "gap_d = -0.2", "release.gap_d"),
    "sphere beyond the box": ("gap_d = 9", "gap_d = 14", "release.gap_d"),
    "too few cells": ("cells_per_diameter = 10", "cells_per_diameter = 4", "numerics.cells_per_diameter"),
    "a quarter of an oblique impact": (
        "ramp = 0.004\n[numerics]\n",
        'ramp = 0.004\nalong = 0.1\n[numerics]\nsymmetry = "quarter"\n',
        "numerics.symmetry",
    ),
    "box too low for the rebound": (
        "cells_per_diameter = 10",
        "cells_per_diameter = 10\nheight_d = 7",
        "numerics.height_d",
    ),
    "box too narrow": ("cells_per_diameter = 10", "cells_per_diameter = 10\nwidth_d = 1.5", "numerics.width_d"),
    "unknown film": ('form = "source_abstract_eq3"', 'form = "glue"', "film.form"),
    "unknown law": ('mode = "dry"', 'mode = "effective"\nlaw = "legendre"', "contact.law"),
    "law of another family": ('mode = "dry"', 'mode = "effective"\nlaw = "brenner_1961"', "contact.law"),
    "loss counted twice": ('mode = "dry"', 'mode = "effective"\nlaw = "legendre_2005"', "film.form"),
    "measured without a record": ('mode = "dry"', 'mode = "effective"\nmeasured = "record"', "contact.measured"),
    "restitution above one": ('mode = "dry"', 'mode = "effective"\nmeasured = [1.2]', "contact.measured"),
    "edge of a film that acts": ('mode = "dry"', 'mode = "dry"\nedge_d = 0.2', "contact.edge_d"),
    "edge beyond any film": (
        'mode = "dry"',
        'mode = "effective"\nmeasured = [0.8]\nedge_d = 1.5',
        "contact.edge_d",
    ),
    "edge of no law": (
        'mode = "dry"',
        'mode = "effective"\nmeasured = [0.8]\nlaw_edge_d = 0.2',
        "contact.law_edge_d",
    ),
    "soft without duration": ('mode = "dry"', 'mode = "soft_linear"', "contact.duration_steps"),
    "key of another mode": ('mode = "dry"', 'mode = "dry"\nduration_steps = 20', "contact.duration_steps"),
    "no end": ("after_contact = 0.1", "", "run.after_contact"),
    "no dry restitution": ("e_dry = 0.97", "", "sphere.e_dry"),
    "roughness above the film": ("roughness = 1.5e-7", "roughness = 0.01", "sphere.roughness"),
    "no roughness": ("roughness = 1.5e-7", "", "film.floor"),
    "drive without ramp": ("ramp = 0.004", "", "release.ramp"),
    "drive faster than sound": (
        "cells_per_diameter = 10",
        "cells_per_diameter = 10\nreference_speed = 0.001",
        "release.speed",
    ),
    "oblique faster than sound": ("ramp = 0.004", "ramp = 0.004\nalong = 40", "release.along"),
    "unknown record": ("[fluid]", 'record = "gondret"\n[fluid]', "record"),
}


@pytest.mark.parametrize("what", BAD)
def test_what_is_wrong_is_named_by_field(what, tmp_path):
    old, new, field = BAD[what]
    assert old in GOOD
    with pytest.raises(InputError) as raised:
        read(tmp_path, GOOD.replace(old, new, 1))
    assert any((d.field or "").startswith(field) for d in raised.value.defects)


@pytest.mark.parametrize("name", ["gondret_152", "no/such/case.toml"])
def test_unknown_cases_are_one_line_and_status_2(name, capsys):
    assert main(["simulate", name]) == 2
    assert len(capsys.readouterr().err.splitlines()) == 1


def test_lattice_speed_out_of_range_says_which_knob(tmp_path, capsys):
    (tmp_path / "fast.toml").write_text(
        GOOD.replace("cells_per_diameter = 10", "cells_per_diameter = 10\nlattice_speed = 0.4")
    )
    for command in (("simulate", "--out", str(tmp_path / "out")), ("cases", "show")):
        assert main([*command, str(tmp_path / "fast.toml")]) == 2
        lines = capsys.readouterr().err.splitlines()
        assert len(lines) == 1
        assert "lattice_speed" in lines[0]
    assert not (tmp_path / "out").exists()


def test_fast_flow_gets_the_rates_that_bear_it_unless_others_are_chosen(tmp_path):
    """Re = 935 x 0.585 x 0.003 / 0.01 = 164.1 over the cells a diameter: 20.5 and 23.4 a cell."""
    found = []
    for cells, chosen in (("8", ""), ("7", ""), ("7", '\nrates = "balanced"')):
        file = tmp_path / f"{len(found)}.toml"
        file.write_text(GOOD.replace("diameter = 10", f"diameter = {cells}{chosen}"))
        found.append(cases.read_case(str(file)).rates)
    assert found == ["balanced-by-place", "dhumieres-by-place", "balanced"]


def test_a_circle_of_bases_ends(tmp_path):
    (tmp_path / "a.toml").write_text('base = "b"\n')
    (tmp_path / "b.toml").write_text('base = "a"\n')
    with pytest.raises(InputError, match="base"):
        cases.read_case(tmp_path / "a.toml")


def test_the_list_names_every_shipped_case(capsys):
    assert main(["simulate", "--list"]) == 0
    out = capsys.readouterr().out
    assert all(name in out for name in cases.names())


def test_a_template_can_be_read_again_and_replaces_nothing(tmp_path, capsys):
    mine = tmp_path / "mine.toml"
    assert main(["simulate", "gondret_st27", "--template", str(mine)]) == 0
    own, shipped = cases.read_case(mine), cases.read_case("gondret_st27")
    assert own.model_copy(update={"name": shipped.name}) == shipped
    assert main(["simulate", "gondret_st27", "--template", str(mine)]) == 2


def test_the_example_can_be_run_and_has_every_key(tmp_path):
    """Each field of a case stands in it, behind a # or not."""
    assert main(["simulate", "--template", str(tmp_path / "mine.toml")]) == 0
    text = (tmp_path / "mine.toml").read_text()
    cases.read_case(tmp_path / "mine.toml")
    for model in (Fluid, Sphere, Wall, Release, Numerics, FilmModel, ContactModel, Span, Study):
        for name in model.model_fields:
            assert re.search(rf"^(# )?{name} = ", text, re.MULTILINE), f"{model.__name__}.{name}"


def test_results_of_one_model_do_not_replace_those_of_the_other(tmp_path, capsys):
    (tmp_path / "run.json").write_text('{"case": "gondret_st27"}')
    assert main(["bounce", "gondret_st27", "--out", str(tmp_path)]) == 2
    assert str(tmp_path) in capsys.readouterr().err
    assert [p.name for p in tmp_path.iterdir()] == ["run.json"]


def test_a_base_that_is_not_there_is_named_with_file_and_field(tmp_path, capsys):
    (tmp_path / "mine.toml").write_text('base = "nowhere"\n')
    assert main(["simulate", str(tmp_path / "mine.toml")]) == 2
    assert f"{tmp_path / 'mine.toml'}: base = 'nowhere'" in capsys.readouterr().err


STUDY = '[study]\nvaries = "width of the box"\nagainst = "gondret_st152_10"\norder = 8\n'


def test_a_study_is_for_readers_alone(tmp_path):
    """What the solver is told and what a checkpoint belongs to do not change; nobody inherits it."""
    (tmp_path / "plain.toml").write_text(GOOD)
    plain = cases.read_case(tmp_path / "plain.toml")
    studied = read(tmp_path, GOOD + STUDY).model_copy(update={"name": "plain"})
    assert studied.study.varies == "width of the box"
    assert told(studied) == told(plain)
    assert checkpoint_key(studied) == checkpoint_key(plain)
    (tmp_path / "heir.toml").write_text('base = "case"\n')
    assert cases.read_case(tmp_path / "heir.toml").study is None


@pytest.mark.parametrize(
    ("study", "field"),
    [
        (STUDY.replace("gondret_st152_10", "gondret_152"), "study.against"),
        (STUDY.replace("gondret_st152_10", "case"), "study.against"),
        ('[study]\nvaries = "width"\n', "study.against"),
        ('[study]\nagainst = "gondret_st152_10"\n', "study.varies"),
        ("[study]\norder = 1\n", "study.varies"),
        (STUDY + "color = 1\n", "study.color"),
    ],
)
def test_a_study_that_says_half_is_refused(tmp_path, study, field):
    with pytest.raises(InputError) as raised:
        read(tmp_path, GOOD + study)
    assert [d.field for d in raised.value.defects] == [field]


def test_a_rebound_that_is_put_in_joins_no_series_of_predicted_ones(tmp_path):
    text = GOOD.replace('"dry"', '"effective"\nlaw = "legendre_2005"').replace('"source_abstract_eq3"', '"none"')
    read(tmp_path, text)
    with pytest.raises(InputError, match=r"study\.series"):
        read(tmp_path, text + '[study]\nseries = "drops"\n')
