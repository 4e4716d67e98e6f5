"""Calibration: from measured impacts to closure parameters, their intervals, a ranking of laws, and predictions.

Data flow one way: files are read by :mod:`~.impact_data` into :class:`~.observations.Observations`; a law or a
user's formula becomes a :class:`~.rebound_model.ReboundModel`; a :class:`~.plan.Plan` says what is estimated;
:mod:`~.likelihood` says how probable the observations are; :mod:`~.maximum` and :mod:`~.posterior` find what they
support, knowing only a function and its parameters; :mod:`~.fitting` puts the parts together; :mod:`~.fit_result`
is what is kept. :mod:`~.ranking`, :mod:`~.prediction` and :mod:`~.design` use it.

Tracks may also become impacts by all their positions: :mod:`~.recordings` are read, :mod:`~.trajectory_likelihood`
says how probable their frames are, on trajectories interpolated by :mod:`~.flight_map` and under the noise of
:mod:`~.correlated_noise`; :mod:`~.whole_trajectories` gives the impacts, :mod:`~.trajectory_fit` the law.
"""
