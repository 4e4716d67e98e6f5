"""Synthetic impacts from a known law, and the plans to fit them: what the tests of calibration share."""

from __future__ import annotations

import numpy as np

from restitution.calibration import Plan, model_of
from restitution.calibration.reading.observations import Observations
from restitution.stokes import Speed

K, E_DRY = 18.0, 0.9


def observations(St, e, e_sigma=0.0, St_sigma=0.0, upper=None, source=None, **labels) -> Observations:
    """Observations from plain arrays; ``upper`` is finite where no rebound was seen."""
    n = len(St)

    def full(x):
        return np.broadcast_to(np.asarray(np.nan if x is None else x, float), n).copy()

    upper = full(upper)
    names = {"source": np.array(["a"] * n if source is None else source, object)}
    return Observations(
        St=full(St),
        St_sigma=full(St_sigma),
        e=np.where(np.isfinite(upper), np.nan, full(e)),
        e_sigma=full(e_sigma),
        correlation=np.zeros(n),
        upper=upper,
        e_dry=full(None),
        e_dry_sigma=full(None),
        labels=names | {k: np.array(v, object) for k, v in labels.items()},
        convention="st",
        speed=Speed.FAR,
        conditions=(None,) * n,
    )


def draw(n, rng, scatter=0.0, St_error=0.0, limit=0.0, offset=0.0, e_sigma=0.01) -> Observations:
    """Impacts of e_dry exp[-K (1 + e_dry)/St], St from 15 to 500; two sources where they are offset."""
    St = np.exp(rng.uniform(np.log(15), np.log(500), n))
    source = np.arange(n) % 2
    e = E_DRY * np.exp(-K * (1 + E_DRY) / St) + np.hypot(e_sigma, scatter) * rng.standard_normal(n)
    e += offset * rng.standard_normal(2)[source]
    seen = St * (1 + St_error * rng.standard_normal(n))
    upper = np.where(e < limit, limit, np.nan)
    names = [f"lab {s}" for s in source] if offset else None
    return observations(seen, e, e_sigma, St_error * seen, upper, names)


def plan(law="eq4_exponential", **options) -> Plan:
    return Plan(model_of(law, options.get("bounds")), **({"e_dry": "free"} | options))
