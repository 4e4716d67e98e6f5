"""Calibration: from measured impacts to closure parameters, their intervals, a ranking of laws, and predictions.

Data flow one way: files are read by :mod:`~.impact_data` into :class:`~.observations.Observations`; a law or a
user's formula becomes a :class:`~.rebound_model.ReboundModel`; a :class:`~.plan.Plan` says what is estimated;
:mod:`~.likelihood` says how probable the observations are; :mod:`~.maximum` and :mod:`~.posterior` find what they
support, knowing only a function and its parameters; :mod:`~.fitting` puts the parts together; :mod:`~.fit_result`
is what is kept. :mod:`~.ranking`, :mod:`~.prediction` and :mod:`~.design` use it.

Tracks may also become impacts by all their positions: :mod:`~.recordings` are read, :mod:`~.trajectory_likelihood`
says how probable their frames are, on trajectories interpolated by :mod:`~.flight_map` and under the noise of
:mod:`~.correlated_noise`; :mod:`~.whole_trajectories` gives the impacts, :mod:`~.trajectory_fit` the law.

A fit in Python::

    observations = read("impacts.csv", stokes="st", speed="far")
    result = result_of(estimate(Plan(model_of("eq4_exponential")), observations))
    predict(result, [30, 60, 120], e_dry=0.97)
    rank([(name, Plan(model_of(name))) for name in ("eq4_exponential", "legendre_2005")], observations)
"""

from restitution.calibration.fit_result import FitResult, read_fit, result_of
from restitution.calibration.fitting import Fit, estimate
from restitution.calibration.impact_data import read
from restitution.calibration.observations import Observations
from restitution.calibration.parameters import Normal
from restitution.calibration.plan import Plan
from restitution.calibration.prediction import Prediction, predict
from restitution.calibration.ranking import Ranking, rank
from restitution.calibration.reading import Reading
from restitution.calibration.rebound_model import model_of

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
