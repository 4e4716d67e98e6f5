import json
import shutil

import mpmath
import numpy as np
import pytest
from scipy.special import gammaln

from restitution import datasets
from restitution.datasets import check_package
from restitution.errors import InputError
from restitution.stokes import convention


def track(name):
    table = datasets.load(name)
    return table.iloc[:, 0].to_numpy(), table.iloc[:, 1].to_numpy()


def apexes(t, gap, above, window):
    """(time, height, downward acceleration) of every maximum higher than ``above``, by a parabola."""
    found = []
    for i in range(2, len(t) - 2):
        if gap[i] == gap[i - 2 : i + 3].max() and gap[i] > above:
            near = np.abs(t - t[i]) < window
            p = np.polynomial.Polynomial.fit(t[near], gap[near], 2)
            top = p.deriv().roots()[0]
            found.append((top, p(top), -p.deriv(2)(top)))
    return np.array(found).T


def resistance(name, function, size_ratio=None):
    """Gaps and values of one function."""
    table = datasets.load(name)
    ratio = table.size_ratio.isna() if size_ratio is None else table.size_ratio == size_ratio
    rows = table[(table.function == function) & ratio]
    assert len(rows) > 0
    return rows.gap_over_radius.to_numpy(), rows.value.to_numpy()


# ---------------------------------------------------------------- the package


def test_the_shipped_package_has_no_defect():
    assert check_package() == []


@pytest.mark.filterwarnings("ignore")  # those of a development-only dependency
def test_frictionless_finds_the_package_valid():
    frictionless = pytest.importorskip("frictionless")
    report = frictionless.validate(str(datasets.folder() / "datapackage.json"))
    assert report.valid, report.flatten(["message"])
    assert len(report.tasks) == len(datasets.names())


@pytest.mark.parametrize("name", datasets.names())
def test_quoted_numbers_agree_with_the_conditions(name):
    r = datasets.resource(name)
    if r.kind == "reference":
        assert r.conditions is None
        return
    quoted, c = r.quoted, r.conditions
    speeds = ("impact_speed_m_s", "approach_speed_m_s", "terminal_speed_m_s")
    speed = next((quoted[key] for key in speeds if key in quoted), None)
    if speed is not None:
        assert convention(r.conventions.stokes).per_speed(c) * speed == pytest.approx(quoted["stokes"], rel=0.01)
        reynolds = c.fluid.density * speed * c.sphere.diameter / c.fluid.viscosity
        assert reynolds == pytest.approx(quoted["reynolds"], rel=0.025)
    assert bool(r.measured) == (r.kind == "measured")


@pytest.fixture
def package(tmp_path):
    return shutil.copytree(datasets.folder(), tmp_path / "data")


def test_a_changed_byte_is_caught(package):
    path = package / "gondret2002/st152.csv"
    path.write_bytes(path.read_bytes().replace(b"0.0091126", b"0.0091127"))
    (defect,) = check_package(package)
    assert defect.file == str(path)
    assert "hash" in defect.rule


def test_all_that_is_wrong_with_a_package_is_named(package):
    (package / "li2012/drop1.csv").unlink()
    (package / "li2012/drop2.csv").write_text("time_s,gap_m\n0,1\n")
    (package / "schemas/settling.json").write_text("{")
    found = check_package(package / "datapackage.json")
    assert [(d.file.removeprefix(f"{package}/"), d.rule.partition(";")[0].partition(":")[0]) for d in found] == [
        ("li2012/drop1.csv", "does not exist"),
        ("li2012/drop2.csv", "has 17 bytes"),
        ("li2012/drop2.csv", "has changed"),
        ("li2012/drop2.csv", "has 1 rows below the header"),
        ("schemas/settling.json", "is not JSON"),
        ("schemas/settling.json", "is not JSON"),
    ]


@pytest.mark.parametrize(
    ("change", "field"),
    [
        ({"kind": "guessed"}, "resources.0.kind"),
        ({"colour": "red"}, "resources.0.colour"),
        ({"path": "../elsewhere.csv"}, "resources.0.path"),
        ({"hash": "md5:0"}, "resources.0.hash"),
        ({"conditions": None}, "resources.0"),
        ({"conventions": {"stokes": "st_9", "speed": "far"}}, "resources.0.conventions.stokes"),
        ({"derived": {"gap": "x"}}, "gondret2002_st152.gap"),
        ({"name": "li2012_drop1"}, "li2012_drop1"),
    ],
)
def test_wrong_metadata_is_named_by_its_field(package, change, field):
    file = package / "datapackage.json"
    content = json.loads(file.read_text())
    content["resources"][0] |= change
    file.write_text(json.dumps(content))
    (defect,) = check_package(package)
    assert (defect.file, defect.field) == (str(file), field)


def test_unknown_names_are_met_with_near_ones():
    with pytest.raises(InputError, match="gondret2002_st152"):
        datasets.load("gondret_st152")
    with pytest.raises(InputError, match="trajectory"):
        datasets.schema("trajectry")


# ---------------------------------------------------------------- measured and simulated records


def test_gondret_st_152():
    t, gap = track("gondret2002_st152")
    r = datasets.resource("gondret2002_st152")
    assert len(t) == 98
    np.testing.assert_allclose(np.diff(t), 0.002, rtol=1e-9)
    speed = -np.polynomial.Polynomial.fit(t[1:8], gap[1:8], 1).deriv()(0)  # the 7 frames before contact
    assert speed == pytest.approx(0.586, abs=5e-4)
    assert convention("st").per_speed(r.conditions) * speed == pytest.approx(152.3, abs=0.2)
    _, height, _ = apexes(t, gap, 2e-4, 0.008)
    np.testing.assert_allclose(height, [7.469e-3, 2.234e-3, 0.529e-3], atol=1e-5)  # the noise
    _, _, acceleration = apexes(t, gap, 2e-3, 0.013)
    c = r.conditions
    buoyant = c.gravity * (c.sphere.density - c.fluid.density) / (c.sphere.density + c.fluid.density / 2)
    np.testing.assert_allclose(acceleration, buoyant, rtol=0.04)
    assert gap[-9:].mean() == pytest.approx(22e-6, abs=1e-6)


def test_gondret_st_27_has_one_flight_and_a_quoted_impact():
    t, gap = track("gondret2002_st27")
    c = datasets.resource("gondret2002_st27").conditions
    assert len(t) == 21
    (time,), (height,), _ = apexes(t, gap, 1e-3, 0.005)
    assert (time, height) == (pytest.approx(18.9e-3, abs=1e-4), pytest.approx(1.967e-3, abs=5e-6))
    reynolds = (
        c.fluid.density * c.sphere.diameter / c.fluid.viscosity * np.array([c.impact.speed, c.impact.speed_sigma])
    )
    # quoted as 30, to two digits: +- 0.5, uniform
    np.testing.assert_allclose(reynolds, [30, 0.5 / 3**0.5], rtol=0.01)


@pytest.mark.parametrize(
    ("drop", "points", "apex_mm"), [(1, 30, 1.38), (2, 31, 3.17), (3, 33, 4.62), (5, 37, 7.54), (6, 39, 8.38)]
)
def test_li_drops(drop, points, apex_mm):
    t, gap = track(f"li2012_drop{drop}")
    assert len(t) == points
    np.testing.assert_allclose(np.diff(t), 0.005, atol=1e-5)
    assert apexes(t, gap, 1e-3, 0.008)[1][0] == pytest.approx(apex_mm * 1e-3, abs=1e-4)  # the level: +- 0.1 mm


@pytest.mark.parametrize("case", ["e1", "e3"])
def test_ten_cate_gap_and_velocity_tell_the_same(case):
    t, gap = track(f"tencate2002_{case}_gap")
    _, v = track(f"tencate2002_{case}_velocity")
    quoted = datasets.resource(f"tencate2002_{case}_gap").quoted
    diameter = datasets.resource(f"tencate2002_{case}_gap").conditions.sphere.diameter
    assert -v.min() == pytest.approx(
        quoted["terminal_speed_m_s"] * quoted["maximum_over_terminal_speed"], rel=0.03
    )
    steady = (gap > 2 * diameter) & (gap < 6 * diameter)
    slope = np.polynomial.Polynomial.fit(t[steady], gap[steady], 1).deriv()(0)
    assert slope == pytest.approx(v.min(), rel=0.05)  # 2-3 % each
    assert gap[0] / diameter == pytest.approx(8.15, abs=0.04)  # the stated offset, not removed: 8.0 is true
    assert quoted["release_gap_m"] / diameter == pytest.approx(8.0)


@pytest.mark.parametrize(("case", "peaks"), [("st152", [2.445, 0.701]), ("st27", [0.3266])])
def test_published_simulations_are_apart_and_peak_as_published(case, peaks):
    r = datasets.resource(f"biegert2017_{case}")
    assert r.kind == "simulated"
    assert r.path.startswith("biegert2017/")
    t, gap = track(f"biegert2017_{case}")
    height = apexes(t, gap, 0.3 * r.conditions.sphere.diameter, 0.012)[1] / r.conditions.sphere.diameter
    np.testing.assert_allclose(height, peaks, rtol=0.01)


# ---------------------------------------------------------------- exact resistances


def test_brenner_is_his_series():
    def series(eps):
        a = mpmath.acosh(1 + mpmath.mpf(eps))

        def term(n):
            top = 2 * mpmath.sinh((2 * n + 1) * a) + (2 * n + 1) * mpmath.sinh(2 * a)
            bottom = 4 * mpmath.sinh((n + 0.5) * a) ** 2 - (2 * n + 1) ** 2 * mpmath.sinh(a) ** 2
            return n * (n + 1) / mpmath.mpf((2 * n - 1) * (2 * n + 3)) * (top / bottom - 1)

        return 4 / mpmath.mpf(3) * mpmath.sinh(a) * sum(term(n) for n in range(1, 400))

    gaps, values = resistance("brenner1961", "F_n")
    assert [f"{float(series(eps)):.6g}" for eps in gaps] == [f"{value:.6g}" for value in values]


def test_goldman_meets_its_asymptotes():
    """Logarithms near the wall (Goldman, Cox & Brenner 1967), reflections far from it (Faxen)."""
    eps, F_t = resistance("goldman1967", "F_t")
    table = {name: resistance("goldman1967", name)[1] for name in ("T_t", "F_r", "T_r", "F_s", "T_s")}
    near, far, k = eps < 0.006, eps > 9, 1 / (1 + eps)
    np.testing.assert_allclose(F_t[near], -8 / 15 * np.log(eps[near]) + 0.9588, rtol=2e-3)
    np.testing.assert_allclose(table["T_r"][near], -2 / 5 * np.log(eps[near]) + 0.3817, rtol=2e-3)
    np.testing.assert_allclose(table["F_s"][near], 1.7005, rtol=3e-3)
    np.testing.assert_allclose(table["T_s"][near], 0.9440, rtol=1e-3)
    np.testing.assert_allclose(F_t[far], 1 / (1 - 9 / 16 * k[far] + k[far] ** 3 / 8), rtol=1e-3)
    np.testing.assert_allclose(table["T_t"][far], 3 / 32 * k[far] ** 4 * (1 - 3 / 8 * k[far]), rtol=3e-3)
    np.testing.assert_allclose(table["T_r"][far], 1 + 5 / 16 * k[far] ** 3, rtol=1e-4)
    np.testing.assert_allclose(table["F_s"][far], 1 + 9 / 16 * k[far], rtol=5e-3)
    np.testing.assert_allclose(table["T_s"][far], 1 - 3 / 16 * k[far] ** 3, rtol=1e-4)
    np.testing.assert_allclose(table["F_r"], 4 / 3 * table["T_t"], rtol=1e-5)


@pytest.mark.parametrize(
    ("function", "pole", "logarithm", "constant"),
    [
        ("XA11", 1 / 4, 9 / 40, 0.99536),
        ("XA12", -1 / 4, -9 / 40, -0.35022),
        ("YA11", 0, 1 / 6, 0.9983),
        ("YA12", 0, -1 / 6, -0.2737),
        ("YB11", 0, -1 / 4, 0.2390),
        ("YB12", 0, 1 / 4, -0.0017),
        ("YC11", 0, 1 / 5, 0.7028),
        ("YC12", 0, 1 / 20, -0.0274),
        ("XC11", 0, 0, 7 / 8 * 1.2020569),
        ("XC12", 0, 0, -1 / 8 * 1.2020569),
    ],
)
def test_equal_spheres_near_contact(function, pole, logarithm, constant):
    """Singular terms and constants of Jeffrey & Onishi (1984), lambda = 1; eps = gap/radius = s' - 2."""
    eps, value = resistance("jeffrey1984", function, 1.0)
    near = eps < 1e-4
    rest = value[near] - pole / eps[near] + logarithm * np.log(eps[near])
    np.testing.assert_allclose(rest, constant, atol=6e-4)
    assert rest[0] == pytest.approx(constant, abs=1e-4)


@pytest.mark.parametrize(("a", "b"), [(0.01, 100.0), (0.1, 10.0), (1.0, 1.0)])
def test_two_spheres_are_reciprocal_dissipative_and_independent_far_apart(a, b):
    for function, power in {"XA12": 1, "YA12": 1, "XC12": 3, "YC12": 3}.items():
        own, other = resistance("jeffrey1984", function, a)[1], resistance("jeffrey1984", function, b)[1]
        np.testing.assert_allclose(own, a**power * other, rtol=3.4e-4)  # the stated error
        self_a = resistance("jeffrey1984", function.replace("12", "11"), a)[1]
        self_b = resistance("jeffrey1984", function.replace("12", "11"), b)[1] * a**power
        assert np.all(self_a >= 1)
        assert np.all(self_a * self_b > own**2)
        assert np.all(np.diff(self_a) <= 1e-8)
    # leading reflections at the largest separation, k being the Stokeslet along or across the line of centres
    eps, XA = resistance("jeffrey1984", "XA11", a)
    _, YA = resistance("jeffrey1984", "YA11", a)
    k = 1 / (1 + a + eps[-1])
    assert XA[-1] == pytest.approx(1 / (1 - 9 / 4 * a * k**2), rel=6e-3)
    assert YA[-1] == pytest.approx(1 / (1 - 9 / 16 * a * k**2), rel=6e-3)


def multipoles(size_ratio, separation, orders=(400, 400)):
    """XA11, XA12 in units of 6 pi mu a1 from the multipole equations of Jeffrey & Onishi (1984), section 3."""
    t = (1 / separation, size_ratio / separation)
    n = [np.arange(1.0, N + 1)[:, None] for N in orders]
    P, V = [], []
    for i, j in ((0, 1), (1, 0)):
        m, s = n[i], n[j].T
        C = np.exp(gammaln(m + s + 1) - gammaln(m + 1) - gammaln(s + 1) + m * np.log(t[i]) + s * np.log(t[j]))
        down = m * (2 * m + 1) * (2 * m * s - m - s + 2) / (2 * (m + 1) * (2 * s - 1) * (m + s)) / t[i]
        B = -C * m * (4 * m**2 - 1) / (2 * (m + 1) * (2 * s + 1)) * t[j] ** 2 / t[i]
        P.append((C * (down - m * (2 * m - 1) / (2 * (m + 1)) * t[i]) + B, B))
        V.append(-2 * m / ((m + 1) * (2 * m + 3)) * C * t[i])
    matrix = np.eye(sum(orders)) - np.block([[P[0][1] @ V[1], P[0][0]], [P[1][0], P[1][1] @ V[0]]])
    unit = np.zeros((sum(orders), 2))
    unit[0, 0] = unit[orders[0], 1] = 1
    return np.linalg.solve(matrix, unit)[0] * [1, -1]


@pytest.mark.parametrize(
    ("size_ratio", "smallest", "tolerance"),
    [(1.0, 4e-3, 1.2e-5), (0.1, 0.01, 4e-4), (10.0, 0.1, 4e-4), (0.01, 0.2, 1.2e-5), (100.0, 20.0, 1.2e-5)],
)
def test_two_spheres_agree_with_their_multipoles(size_ratio, smallest, tolerance):
    for i, function in enumerate(("XA11", "XA12")):
        gaps, values = resistance("jeffrey1984", function, size_ratio)
        for eps, value in list(zip(gaps, values, strict=True))[::5]:
            if eps > smallest:
                expected = multipoles(size_ratio, 1 + size_ratio + eps)[i]
                assert value == pytest.approx(expected, rel=tolerance), (function, eps)
