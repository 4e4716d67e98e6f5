"""What a file says of a fit is used where its parts belong together, and refused by file and field where not."""

import copy
import json
import math

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from restitution.calibration.result.fit_file import read_fit
from restitution.calibration.result.prediction import predict
from restitution.cli import main
from restitution.errors import InputError

IMPACTS = "stokes,e_eff,e_eff_sigma,e_dry,stokes_convention,speed_definition,source\n" + "".join(
    f"{St},{0.97 * math.exp(-35 / St) + 0.01 * (-1) ** k},0.01,0.97,st,far,{'AB'[k % 2]}\n"
    for k, St in enumerate((20, 30, 45, 70, 100, 150, 220, 330))
)


@pytest.fixture(scope="module")
def good(tmp_path_factory):
    folder = tmp_path_factory.mktemp("fit")
    (folder / "impacts.csv").write_text(IMPACTS)
    assert (
        main(["fit", str(folder / "impacts.csv"), "--law", "eq4_exponential", "--out", str(folder / "f.json")])
        == 0
    )
    return json.loads((folder / "f.json").read_text())


def read(content, tmp_path):
    path = tmp_path / "edited.json"
    path.write_text(json.dumps(content))
    return read_fit(path)


def places(content, here=()):
    """Every place of a nested content."""
    inner = (
        content.items() if isinstance(content, dict) else enumerate(content) if isinstance(content, list) else ()
    )
    for key, value in inner:
        if here[:1] == ("draws",) and isinstance(key, int) and key > 1:
            break  # draws are many and alike
        yield (*here, key)
        yield from places(value, (*here, key))


def test_a_good_one_is_read(good, tmp_path):
    prediction = predict(read(good, tmp_path), 100.0, 0.97)
    assert prediction.law["95%"][0][0] < prediction.value[0] < prediction.law["95%"][0][1]


VALUES = [None, -1, 0, 1e300, -1e300, 1e-320, "", "x", "nan", [], [[]], {}, True, "\0", [1, 2, 3], "K"]


@settings(suppress_health_check=[HealthCheck.function_scoped_fixture], deadline=None, max_examples=400)
@given(
    place=st.integers(0, 10**6),
    deed=st.sampled_from(["replace", "delete", "repeat"]),
    value=st.sampled_from(VALUES) | st.floats(allow_nan=False, allow_infinity=False),
)
def test_an_edit_is_refused_by_name_or_leaves_a_sound_prediction(good, tmp_path, place, deed, value):
    content = copy.deepcopy(good)
    everywhere = list(places(good))
    *above, last = everywhere[place % len(everywhere)]
    holder = content
    for key in above:
        holder = holder[key]
    if deed == "replace":
        holder[last] = copy.deepcopy(value)
    elif deed == "delete":
        del holder[last]
    elif isinstance(holder, list):
        holder.append(holder[last])
    refused = None
    try:
        result = read(content, tmp_path)
    except InputError as error:
        refused = error
    if refused is not None:
        assert all(d.file and d.file.endswith("edited.json") for d in refused.defects)
        return
    try:
        found = predict(result, [20.0, 330.0], 0.97)
    except InputError:
        return
    for ends in (*found.law.values(), *found.impact.values()):
        assert np.isfinite(ends).all()
        assert (ends[:, 0] <= found.value).all()
        assert (found.value <= ends[:, 1]).all()


def parameter(content, **fields):
    content["parameters"][0] |= fields


def negative_definite(content):
    n = len(content["covariance"])
    content["covariance"] = [[1.0 if i == j else -0.9 for j in range(n)] for i in range(n)]


EDITS = {
    "a value below its bound": lambda c: parameter(c, value=-5.0),
    "no degrees of freedom": lambda c: parameter(c, degrees_of_freedom=0.0),
    "negative ones": lambda c: parameter(c, degrees_of_freedom=-3.0),
    "an interval that falls": lambda c: parameter(c, intervals={"68%": [2.0, 1.0], "95%": [1.0, 2.0]}),
    "an interval that is missing": lambda c: parameter(c, intervals={"68%": [1.0, 2.0]}),
    "an unknown name": lambda c: parameter(c, name="Q"),
    "a parameter twice": lambda c: c["parameters"].append(c["parameters"][0]),
    "no parameters": lambda c: c.update(parameters=[], covariance=[]),
    "a covariance of one": lambda c: c.update(covariance=[[1.0]]),
    "an empty covariance": lambda c: c.update(covariance=[]),
    "a negative variance": lambda c: c["covariance"][0].__setitem__(0, -1.0),
    "a covariance that is none": negative_definite,
    "no points": lambda c: c.update(points=[]),
    "an unknown convention": lambda c: c["law"].update(convention="xx"),
    "an unknown one of the data": lambda c: c.update(stokes_convention="xx"),
    "an unknown speed": lambda c: c.update(speed_definition="xx"),
    "draws of another estimate": lambda c: parameter(c, value=80.0),
    "fewer weights than draws": lambda c: c["draws"]["weights"].pop(),
    "a draw that is too short": lambda c: c["draws"]["rows"][0].pop(),
    "a range that falls": lambda c: c.update(stokes_range=[100.0, 10.0]),
}


@pytest.mark.parametrize("edit", EDITS)
def test_what_does_not_belong_together_is_refused(edit, good, tmp_path):
    content = copy.deepcopy(good)
    EDITS[edit](content)
    with pytest.raises(InputError, match=r"edited\.json"):
        read(content, tmp_path)
