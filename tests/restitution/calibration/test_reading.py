"""What is read: digitised plots, censored impacts against dropped ones, separate parameters, the report."""

import json
import re

import numpy as np
import pytest

from restitution import datasets
from restitution.calibration import estimate, result_of
from restitution.calibration.estimation.parameters import Normal
from restitution.calibration.reading.digitizer import read_export
from restitution.calibration.reading.observations import Observations
from restitution.calibration.reading.reading import Reading
from restitution.calibration.reading.track_impacts import from_track
from restitution.calibration.result.fit_file import read_fit
from restitution.cli import main
from restitution.errors import InputError
from restitution.impacts import find_impacts
from restitution.report.fits import report
from restitution.stokes import Speed
from restitution.tracks import Track
from tests.fits import E_DRY, draw, observations, plan


def project(points, rotation=0.0, aligned=False):
    """A WebPlotDigitizer project: x logarithmic from 10 to 1000 over 400 pixels, y from 0 to 1 over 300."""
    turn = np.array([[np.cos(rotation), -np.sin(rotation)], [np.sin(rotation), np.cos(rotation)]])

    def pixel(x, y):
        return (turn @ np.array([400 * np.log10(x / 10) / 2 + 60, 350 - 300 * y])).tolist()

    corners = [((10, 0), "10", ""), ((1000, 0), "1000", ""), ((10, 0), "", "0"), ((10, 1), "", "1")]
    calibration = [
        dict(zip(("px", "py"), pixel(*at), strict=True), dx=dx, dy=dy, dz=None) for at, dx, dy in corners
    ]
    axes = {"name": "XY", "type": "XYAxes", "isLogX": True, "isLogY": False, "noRotation": aligned}
    data = [dict(zip(("x", "y"), pixel(*p), strict=True), value=[0, 0]) for p in points]
    dataset = {"name": "figure 3", "axesName": "XY", "data": data, "colorRGB": [0, 0, 0]}
    return {"version": [4, 2], "axesColl": [axes | {"calibrationPoints": calibration}], "datasetColl": [dataset]}


POINTS = [(15.0, 0.12), (40.0, 0.45), (90.0, 0.66), (300.0, 0.88), (700.0, 0.93)]


@pytest.mark.parametrize("rotation", [0.0, 0.03])
def test_pixels_become_values_by_the_axes(tmp_path, rotation):
    (tmp_path / "wpd.json").write_text(json.dumps(project(POINTS, rotation)))
    table = read_export(tmp_path / "wpd.json", ("stokes", "e_eff"))
    np.testing.assert_allclose(table[["stokes", "e_eff"]].to_numpy(), POINTS, rtol=1e-9)
    # one pixel: 1/300 of the y axis, 2 decades/400 of the logarithmic x axis, by hand
    np.testing.assert_allclose(table["e_eff_sigma"], 1 / 300, rtol=1e-9)
    np.testing.assert_allclose(table["stokes_sigma"], np.log(100) / 400 * table["stokes"], rtol=1e-9)


def test_exports_are_fitted_alike(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "wpd.json").write_text(json.dumps(project(POINTS)))
    (tmp_path / "bare.csv").write_text("".join(f"{x}, {y}\n" for x, y in POINTS))
    (tmp_path / "sets.csv").write_text("figure 3,\nX,Y\n" + "".join(f"{x},{y}\n" for x, y in POINTS))
    found = []
    for name in ("wpd.json", "bare.csv", "sets.csv"):
        options = ["--stokes", "st", "--speed", "far", "--e-dry", "0.97", "--out", "fit.json"]
        assert main(["fit", name, *options]) == 0
        found.append(read_fit("fit.json").parameters[0].value)
    assert found[1] == pytest.approx(found[2], rel=1e-6)
    assert found[0] == pytest.approx(found[1], rel=0.1)
    assert main(["fit", "bare.csv", "--speed", "far", "--e-dry", "0.97"]) == 2
    assert "--stokes" in capsys.readouterr().err


def test_a_project_without_calibration_is_refused(tmp_path):
    content = project(POINTS)
    content["axesColl"][0]["calibrationPoints"][1]["dx"] = "10"
    (tmp_path / "wpd.json").write_text(json.dumps(content))
    with pytest.raises(InputError, match="calibration"):
        read_export(tmp_path / "wpd.json", ("stokes", "e_eff"))
    (tmp_path / "wpd.json").write_text('{"datasetColl": []}')
    with pytest.raises(InputError, match="axesColl"):
        read_export(tmp_path / "wpd.json", ("stokes", "e_eff"))


def test_no_rebound_is_a_limit_neither_dropped_nor_zero():
    """A law steep at a threshold: limits below it hold St_c up, where dropping them leaves it free."""
    rng = np.random.default_rng(8)
    St = np.concatenate([np.linspace(60, 300, 8), [12.0, 16.0, 20.0, 24.0]])
    e = 0.9 * (1 - 30 / St) + 0.02 * rng.standard_normal(12)
    upper = np.where(e < 0.05, 0.05, np.nan)
    options = {"law": "max(0, c*(1 - a/St))", "bounds": {"a": (1.0, 80.0), "c": (0.3, 1.0)}, "e_dry": 1.0}
    limits = estimate(plan(**options), observations(St, e, 0.02, upper=upper))
    seen = np.isnan(upper)
    dropped = estimate(plan(**options), observations(St[seen], e[seen], 0.02))
    zeros = estimate(plan(**options, scatter=False), observations(St, np.where(seen, e, 0.0), 0.02))
    # The parameters stand in the order of the formula: c, a.
    assert abs(limits.maximum.values[1] - 30) < 3 * limits.maximum.sigma[1]
    assert limits.maximum.sigma[1] <= 1.001 * dropped.maximum.sigma[1]
    # -ln L of the limits at a law that rebounds there: Phi((0.05 - f)/s), by hand
    f = 0.9 * (1 - 10 / St[~seen])
    from scipy.stats import norm

    values = np.array([0.9, 10.0])
    with_limits = plan(**options, scatter=False).likelihood(observations(St, e, 0.02, upper=upper))
    without = plan(**options, scatter=False).likelihood(observations(St[seen], e[seen], 0.02))
    assert with_limits(values) - without(values) == pytest.approx(-norm.logcdf((0.05 - f) / 0.02).sum())
    assert zeros.maximum.negative_log != pytest.approx(limits.maximum.negative_log)


def test_one_K_for_all_and_one_e_dry_a_material():
    rng = np.random.default_rng(3)
    St = np.tile(np.geomspace(20, 400, 15), 2)
    material = np.repeat(["steel", "nylon"], 15)
    e_dry = np.where(material == "steel", 0.97, 0.85)
    e = e_dry * np.exp(-18 * (1 + e_dry) / St) + 0.01 * rng.standard_normal(30)
    o = observations(St, e, 0.01, material=material)
    fit = estimate(plan(separate={"e_dry": "material"}), o)
    found = dict(zip([p.name for p in fit.maximum.parameters], fit.maximum.values, strict=True))
    sigma = dict(zip(found, fit.maximum.sigma, strict=True))
    for name, truth in {"K": 18, "e_dry[steel]": 0.97, "e_dry[nylon]": 0.85}.items():
        assert abs(found[name] - truth) < 3.5 * sigma[name], name


def test_an_uncertain_e_dry_widens_the_interval_of_K():
    o = draw(30, np.random.default_rng(2))
    known = estimate(plan(e_dry=E_DRY), o).maximum.sigma[0]
    uncertain = estimate(plan(e_dry=Normal(E_DRY, 0.01)), o).maximum.sigma[0]
    free = estimate(plan(), o).maximum.sigma[0]
    assert known < uncertain <= 1.001 * free


def test_robust_errors_survive_an_outlier():
    o = draw(40, np.random.default_rng(6))
    o.e[20] -= 0.4
    robust, normal = (estimate(plan(robust=r), o).maximum for r in (True, False))
    assert abs(robust.values[0] - 18) < 3 * robust.sigma[0]
    assert robust.sigma[0] < 0.5 * normal.sigma[0]


def test_short_coverage():
    """A short form of benchmarks/coverage.py: 60 sets of 20 impacts; bounds at three deviations."""
    rng = np.random.default_rng(1)
    held = {0.68: 0, 0.95: 0}
    for _ in range(60):
        found = estimate(plan(), draw(20, rng, scatter=0.03, St_error=0.03)).maximum
        for level in held:
            low, high = found.intervals[level][0]
            held[level] += low <= 18 <= high
    assert abs(held[0.68] / 60 - 0.68) < 3 * np.sqrt(0.68 * 0.32 / 60)
    assert abs(held[0.95] / 60 - 0.95) < 3 * np.sqrt(0.95 * 0.05 / 60)


def test_report_is_whole_and_loads_nothing(tmp_path):
    o = draw(25, np.random.default_rng(4), scatter=0.03, limit=0.1, offset=0.03)
    names = report.write(tmp_path / "out", result_of(estimate(plan(), o)))
    assert {p.name for p in (tmp_path / "out").iterdir()} == set(names)
    page = (tmp_path / "out" / "index.html").read_text()
    assert not re.search(r'(src|href)="(?!data:)', page)
    again = report.write(tmp_path / "again", read_fit(tmp_path / "out" / "fit.json"))
    for name in again:
        assert (tmp_path / "again" / name).read_bytes() == (tmp_path / "out" / name).read_bytes(), name


def test_a_missing_limit_is_said_to_count_as_zero(tmp_path, capsys):
    rows = [f"{s},st,far,0.97,{0.97 * np.exp(-15 / s):.3f},0.02,rebound" for s in (20, 40, 80, 160, 320)]
    rows.append("12,st,far,0.97,,,no_rebound")
    header = "stokes,stokes_convention,speed_definition,e_dry,e_eff,e_eff_sigma,outcome"
    (tmp_path / "some.csv").write_text("\n".join([header, *rows]) + "\n")
    main(["fit", str(tmp_path / "some.csv"), "--law", "eq4_exponential"])
    assert "e_eff_upper" in capsys.readouterr().out


def test_impacts_of_ones_own_are_observations_without_a_file():
    """Rows as found in a track; what is not stated is taken from the conditions, limits from a typical error."""
    conditions = datasets.resource("gondret2002_st152").conditions
    rows = find_impacts(datasets.load_track("gondret2002_st152"), conditions, record="mine").rows
    o = Observations.from_impacts(rows, conditions)
    seen = ~o.censored
    assert o.convention == "st"
    assert o.speed == "far"
    assert set(o.labels["source"]) == {"mine"}
    assert list(o.e[seen]) == [row["e_eff"] for row in rows if row["outcome"] == "rebound"]
    bare = Observations.from_impacts(
        {"stokes": [50.0, 5.0], "e_eff": [0.6, None], "e_eff_upper": [None, 0.1], "e_eff_sigma": [0.02, None],
         "outcome": ["rebound", "no_rebound"], "stokes_convention": "st", "speed_definition": "far"},
        conditions,
    )  # fmt: skip
    assert list(bare.e_dry) == [0.97, 0.97]
    assert list(bare.e_sigma) == [0.02, 0.02]
    assert bare.upper[1] == 0.1
    with pytest.raises(InputError, match="stokes_convention"):
        Observations.from_impacts([rows[0], rows[1] | {"stokes_convention": "st_star"}], conditions)


def test_a_rebound_faster_than_its_impact_is_refused_in_ones_own_track_too():
    conditions = datasets.resource("gondret2002_st152").conditions
    track = datasets.load_track("gondret2002_st152")
    after = track.time_s > 0
    fast = Track(track.time_s, np.where(after, 4 * track.value, track.value), "gap", track.sigma)
    with pytest.raises(InputError, match="unphysical"):
        from_track(fast, conditions, Reading(speed=Speed.FAR), "mine.csv", "")
    assert from_track(fast, conditions, Reading(speed=Speed.FAR, unphysical=True), "mine.csv", "").e[0] > 1
