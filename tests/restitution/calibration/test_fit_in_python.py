"""A fit in Python as a user writes it: three imports, six lines, and results that show themselves."""

import re
import subprocess
import sys

import numpy as np
import pytest

from restitution import calibration
from restitution.calibration import Plan, estimate, model_of, predict, rank, read, result_of
from restitution.laws.source_abstract_eq4 import READINGS


@pytest.fixture(scope="module")
def fitted():
    impacts = read(["gondret2002_st152", "li2012_drop3", "li2012_drop5"], speed="contact")
    fit = estimate(Plan(model_of("eq4_exponential")), impacts)
    result = result_of(fit)
    prediction = predict(result, [30, 60, 120], e_dry=0.97)
    ranking = rank([(name, Plan(model_of(name))) for name in READINGS[:3]], impacts)
    return impacts, fit, result, prediction, ranking


def test_six_lines_fit_predict_and_rank(fitted):
    _, _, result, prediction, ranking = fitted
    K = result.values["K"]
    np.testing.assert_allclose(prediction.value, 0.97 * np.exp(-K * 1.97 / np.array([30, 60, 120])), rtol=1e-9)
    assert ranking.rows()[0].best
    assert [row.behind for row in ranking.rows()] == sorted(row.behind for row in ranking.rows())
    # At one e_dry the first two readings are the same curve.
    rows = {row.law: row for row in ranking.rows()}
    assert abs(rows["eq4_exponential"].behind - rows["eq4_exponential_over_e"].behind) < 0.1


def test_results_show_their_numbers_not_their_arrays(fitted):
    impacts, fit, result, prediction, ranking = fitted
    for shown in fitted:
        text, page = repr(shown), shown._repr_html_()
        assert str(shown) == text
        assert len(text.splitlines()) < 12
        assert "array(" not in text
        rows = re.findall(r"<tr><td>(.*?)</td>", page)
        assert rows == [line.split()[0] for line in text.splitlines()[-len(rows) :]]
    (line,) = [line for line in repr(result).splitlines() if line.split()[0] == "K"]
    low, high = result.parameters[0].intervals["95%"]
    assert [float(x) for x in line.split()[-3::2]] == pytest.approx([low, high], rel=1e-4)
    assert f"{len(impacts)} impacts" in repr(impacts)
    assert "K" in repr(fit)
    assert f"{prediction.value[0]:.3f}" in repr(prediction)
    assert "eq4_rational" in repr(ranking)


def test_the_face_hands_on_what_it_names():
    assert all(hasattr(calibration, name) for name in calibration.__all__)


def test_the_command_line_starts_without_it():
    code = "import sys, restitution.cli; sys.exit('restitution.calibration' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0
