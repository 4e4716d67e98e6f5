"""Calibration: from measured impacts to closure parameters, their intervals, a ranking of laws, and predictions.

Data flow one way: files are read by :mod:`~.reading.impact_data` into
:class:`~.reading.observations.Observations`; a law or a user's formula becomes a
:class:`~.estimation.rebound_model.ReboundModel`; a :class:`~.estimation.plan.Plan` says what is estimated;
:mod:`~.estimation.likelihood` says how probable the observations are; :mod:`~.estimation.maximum` and
:mod:`~.estimation.posterior` find what they support, knowing only a function and its parameters;
:mod:`~.estimation.fitting` puts the parts together; :mod:`~.result.fit_result` is what is kept.
:mod:`~.result.ranking`, :mod:`~.result.prediction` and :mod:`~.result.design` use it.

Tracks may also become impacts by all their positions: :mod:`~.trajectories.recordings` are read,
:mod:`~.trajectories.likelihood` says how probable their frames are, on trajectories interpolated by
:mod:`~.trajectories.flight_map` and under the noise of :mod:`~.trajectories.correlated_noise`;
:mod:`~.trajectories.whole_trajectories` gives the impacts, :mod:`~.trajectories.fit` the law.

:mod:`~.showing` is how results show themselves. A fit in Python::

    observations = read("impacts.csv", stokes="st", speed="far")
    result = result_of(estimate(Plan(model_of("eq4_exponential")), observations))
    predict(result, [30, 60, 120], e_dry=0.97)
    rank([(name, Plan(model_of(name))) for name in ("eq4_exponential", "legendre_2005")], observations)
"""

from restitution.calibration.estimation.fitting import Fit, estimate
from restitution.calibration.estimation.parameters import Normal
from restitution.calibration.estimation.plan import Plan
from restitution.calibration.estimation.rebound_model import model_of
from restitution.calibration.reading.impact_data import read
from restitution.calibration.reading.observations import Observations
from restitution.calibration.reading.reading import Reading
from restitution.calibration.result.fit_file import read_fit
from restitution.calibration.result.fit_result import FitResult, result_of
from restitution.calibration.result.prediction import Prediction, predict
from restitution.calibration.result.ranking import Ranking, rank

__all__ = [
    "Fit",
    "FitResult",
    "Normal",
    "Observations",
    "Plan",
    "Prediction",
    "Ranking",
    "Reading",
    "estimate",
    "model_of",
    "predict",
    "rank",
    "read",
    "read_fit",
    "result_of",
]
