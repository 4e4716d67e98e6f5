"""Texts for flow solvers: what they would compute, as far as it can be tried without them, and what is refused."""

import math
import re
import shutil
import subprocess

import pytest

from restitution import laws
from restitution.conditions import Conditions
from restitution.errors import InputError
from restitution.export import FilmRequest, Options, Request, law_closure
from restitution.export.targets import target

STEEL = Conditions.model_validate(
    {
        "fluid": {"density": 935.0, "viscosity": 0.01},
        "sphere": {"diameter": 0.003, "density": 7800.0, "e_dry": 0.97},
    }
)
RANGE = (20.0, 1000.0)


def text(to: str, law: str = "eq4_exponential", level: int = 0, speed: float | None = None, **film: float) -> str:
    options = Options(
        conditions=STEEL, request=Request(level, speed, 0.02, RANGE), film=FilmRequest(speed=speed, **film)
    )
    return target(to).text(law_closure(laws.get(law)), options)


def number(key: str, exported: str) -> float:
    return float(re.search(rf"^\s*{re.escape(key)}[ =]+([\d.e-]+)", exported, re.MULTILINE)[1])


def run(folder, source: str, name: str = "main.cpp") -> list[float]:
    compiler = shutil.which("g++")
    if compiler is None:
        pytest.skip("g++ is not installed: the C++ was not compiled")
    (folder / name).write_text(source)
    flags = ["-std=c++11", "-Wall", "-Werror", "-Wno-unused-function"]
    subprocess.run([compiler, *flags, name, "-o", "main"], cwd=folder, check=True)
    return [
        float(x) for x in subprocess.run(["./main"], cwd=folder, check=True, capture_output=True).stdout.split()
    ]


def test_constants_are_the_law_at_the_speed():
    e = 0.97 * math.exp(-18 * 1.97 / 78)  # St of 0.3 m/s
    assert number("DES_EN_WALL_INPUT(1)", text("mfix", speed=0.3)) == pytest.approx(e, rel=1e-8)
    exported = text("openfoam", speed=0.3)
    assert [float(x) for x in re.findall(r"\be +([\d.]+);", exported)] == pytest.approx([e, e], rel=1e-8)


@pytest.mark.targets
def test_openlb_gets_e_at_walls_and_of_pairs(tmp_path):
    calls = '#include <cstdio>\nint main() { std::printf("%.17g %.17g %.17g\\n", '
    calls += "restitution_at_wall(0.3, 0.003, 7800), restitution_of_pair(0.15, 0.003, 7800, 0.003, 7800), "
    calls += "restitution_at_wall(1e-9, 0.003, 7800)); }\n"
    wall, pair, slow = run(tmp_path, text("openlb", level=2) + calls)
    assert wall == pytest.approx(0.97 * math.exp(-18 * 1.97 / 78), rel=1e-12)
    assert pair == pytest.approx(wall, rel=1e-12)  # half the speed, twice the St
    assert slow == 0.001


STUB = """
#include <memory>
#define TypeName(x) static const char *typeName
namespace Foam {
typedef double scalar;
struct vector { double x, y, z; };
inline vector operator-(vector a, vector b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
inline vector operator*(double s, vector a) { return {s*a.x, s*a.y, s*a.z}; }
inline double operator&(vector a, vector b) { return a.x*b.x + a.y*b.y + a.z*b.z; }
inline void operator-=(vector &a, vector b) { a = a - b; }
template<class T> using autoPtr = std::unique_ptr<T>;
struct dictionary {}; struct polyPatch {};
struct Parcel {
    vector u; vector &U() { return u; } double d() const { return 0.003; } double rho() const { return 7800; }
};
struct Cloud {
    typedef Parcel parcelType;
    void patchData(Parcel &, const polyPatch &, vector &n, vector &U) const { n = {0, 0, -1}; U = {0.5, 0, 0.1}; }
};
template<class C> struct PatchInteractionModel {
    C &cloud;
    PatchInteractionModel(const dictionary &, C &c, const char *) : cloud(c) {}
    const C &owner() const { return cloud; }
    virtual ~PatchInteractionModel() {}
    virtual bool correct(Parcel &, const polyPatch &, bool &) = 0;
    virtual autoPtr<PatchInteractionModel<C>> clone() const = 0;
};
}
"""


@pytest.mark.targets
def test_openfoam_turns_the_normal_velocity_alone(tmp_path):
    """The class against stand-ins for the few things that it takes of OpenFOAM; a wall that moves."""
    (tmp_path / "PatchInteractionModel.H").write_text(STUB)
    source = text("openfoam", level=2) + (
        "#include <cstdio>\ntemplate<> const char *Foam::Eq4ExponentialInteraction<Foam::Cloud>::typeName = 0;\n"
        "int main() { using namespace Foam; Cloud c; dictionary d; polyPatch pp; bool keep = false;\n"
        "Eq4ExponentialInteraction<Cloud> m(d, c); Parcel p; p.u = {2, 3, -0.2};\n"
        'm.correct(p, pp, keep); std::printf("%.17g %.17g %.17g ", p.u.x, p.u.y, p.u.z);\n'
        'p.u = {2, 3, 0.2}; m.correct(p, pp, keep); std::printf("%.17g %d\\n", p.u.z, keep); }\n'
    )
    x, y, rebound, away, kept = run(tmp_path, source)
    e = 0.97 * math.exp(-18 * 1.97 / 78)  # 0.3 m/s relative to the wall
    assert (x, y, away, kept) == (2, 3, 0.2, 1)
    assert rebound == pytest.approx(0.1 + e * 0.3, rel=1e-12)


def test_codes_with_a_film_get_e_dry_and_a_least_gap():
    """Gondret's 3 mm sphere: 0.15 um of roughness, 1e-4 of its radius; 20 cells of 0.15 mm."""
    walberla = text("walberla", "roughness", cells=20)
    assert number("restitutionCoeff", walberla) == 0.97
    assert number("lubricationMinimalGapSizeNonDim", walberla) == pytest.approx(1e-4)
    lethe = text("lethe", "roughness", cells=20)
    assert number("set lubrication range min", lethe) == pytest.approx(1e-3)
    assert number("set wall restitution coefficient", lethe) == 0.97
    pfm = text("liggghts-pfm", "nijssen_2022", speed=0.585, modulus=55e9)
    assert "surfaceRoughness peratomtype 1.5e-07" in pfm
    assert number("coefficient_of_restitution", text("mfc", "roughness")) == 0.97
    # 0.37 [(mu v/E)^2 r^3]^(1/5) of the smooth sphere, by hand, in radii
    smooth = 0.37 * ((0.01 * 0.585 / 55e9) ** 2 * 0.0015**3) ** 0.2 / 0.0015
    elastic = text("walberla", "yang_hunt_2008", cells=20, speed=0.585, modulus=55e9)
    assert number("lubricationMinimalGapSizeNonDim", elastic) == pytest.approx(smooth, rel=1e-5)


@pytest.mark.parametrize("to", ["walberla", "lethe", "liggghts-pfm", "mfc", "openfoam", "mfix", "openlb"])
def test_every_text_says_what_it_was_not_tried_with(to):
    rebound = to in ("openfoam", "mfix", "openlb")
    exported = text(to, "eq4_exponential" if rebound else "roughness", 2 if to == "openlb" else 0, 0.3, cells=10)
    assert "not tried" in exported or "the second was not" in exported


@pytest.mark.parametrize(
    ("to", "law", "level", "named"),
    [
        ("walberla", "eq4_exponential", 0, "twice"),
        ("lethe", "legendre_2005", 2, "twice"),
        ("liggghts-pfm", "eq4_exponential", 0, "twice"),
        ("mfc", "eq4_exponential", 0, "twice"),
        ("openfoam", "roughness", 0, "twice"),
        ("mfix", "taylor_1925", 0, "twice"),
        ("walberla", "taylor_1925", 0, "least gap"),
        ("lethe", "ehd_length", 0, "least gap"),
        ("lethe", "roughness", 0, "--cells"),
        ("lethe", "nijssen_2022", 0, "--modulus"),
        ("liggghts-pfm", "yang_hunt_2008", 0, "--modulus"),
        ("openfoam", "eq4_exponential", 1, "level 0 and 2"),
        ("mfix", "eq4_exponential", 2, "level 0"),
        ("openlb", "bertin_2024", 2, "--to csv"),
    ],
)
def test_what_cannot_be_is_refused(to, law, level, named):
    with pytest.raises(InputError, match=named):
        text(to, law, level, 0.3)
