"""Input of other solvers for a case: read back by their own rules, it is the same sphere, fluid and fall."""

import re

import pytest

from restitution.cases.reading import read_case
from restitution.errors import InputError
from restitution.export.solvers import case_file


def blocks(text: str) -> dict[str, dict[str, str]]:
    """waLBerla's blocks: ``Name { key value; ... }``."""
    plain = re.sub(r"//.*", "", text)
    return {
        name: dict(line.split(None, 1) for line in body.strip().rstrip(";").split(";\n"))
        for name, body in re.findall(r"(\w+)\s*\{(.*?)\}", plain, re.DOTALL)
    }


def sections(text: str) -> dict[str, str]:
    """deal.II's parameters, by the path of their subsections; fails where one is not closed."""
    path, values = [], {}
    for line in text.splitlines():
        word, _, rest = line.strip().partition(" ")
        if word == "subsection":
            path.append(rest)
        elif word == "end":
            path.pop()
        elif word == "set":
            key, _, value = rest.partition("=")
            values["/".join([*path, key.strip()])] = value.strip()
    assert not path
    return values


@pytest.mark.parametrize("name", ["gondret_st152_10", "gondret_st27_imposed", "li_drop3"])
def test_walberla_computes_the_speed_and_the_gap_of_the_case(name):
    case = read_case(name)
    read = blocks(case_file("walberla", case, name))
    run, of_case = read["BouncingSphere"], read[read["BouncingSphere"]["setup"]]
    viscosity = float(of_case["dynamicViscosityFluid_SI"]) / float(of_case["densityFluid_SI"])
    d = float(of_case["diameter_SI"])
    assert float(of_case["Re"]) * viscosity / d == pytest.approx(case.reference_speed, rel=1e-6)
    height = float(of_case["domainSize"].strip("<>").split(",")[2])
    assert height - 1.5 - 0.5 == pytest.approx(case.release.gap_d)  # its centre starts 1.5 d below the top
    assert float(run["lubricationMinimalGapSizeNonDim"]) * d / 2 == pytest.approx(case.floor)
    assert run["artificiallyAccelerateSphere"] == ("true" if case.release.kind == "drive" else "false")


@pytest.mark.parametrize("name", ["gondret_st152_10", "gondret_st27_imposed", "li_drop3"])
def test_lethe_gets_the_sphere_at_its_gap_in_a_box_that_holds_it(name):
    case = read_case(name)
    d, read = case.sphere.diameter, sections(case_file("lethe", case, name))
    x, y, z = map(float, read["particles/particle info 0/position/Function expression"].split(";"))
    assert z - d / 2 == pytest.approx(case.release.gap_d * d)
    cells, _, far, coloured = (part.strip() for part in read["mesh/grid arguments"].split(":"))
    wide, _, high = map(float, far.split(","))
    assert coloured == "true"
    assert (x, y) == pytest.approx((wide / 2, wide / 2))
    assert z + d / 2 < high
    finest = wide / int(cells.split(",")[0]) / 2 ** int(read["mesh adaptation/max refinement level"])
    assert d / finest >= case.numerics.cells_per_diameter
    least = float(read["particles/DEM/lubrication range min"]) * finest
    assert least == pytest.approx(case.floor, rel=1e-4)
    nu = float(read["physical properties/fluid 0/kinematic viscosity"])
    assert nu * case.fluid.density == pytest.approx(case.fluid.viscosity)


def test_what_cannot_be_told_is_refused_by_its_field():
    case = read_case("gondret_st152_10")
    bare = case.sphere.model_copy(update={"roughness": None})
    for changed, field in (
        ({"numerics": None}, "numerics"),
        ({"sphere": bare, "wall": None}, "sphere.roughness"),
        ({"sphere": case.sphere.model_copy(update={"e_dry": None})}, "sphere.e_dry"),
        ({"release": case.release.model_copy(update={"along": 0.1})}, "release.along"),
    ):
        with pytest.raises(InputError) as refused:
            case_file("lethe", case.model_copy(update=changed), "mine.toml")
        assert refused.value.defects[0].field == field
    with pytest.raises(InputError, match="walberla, lethe"):
        case_file("palabos", case, "mine.toml")
