"""The certified sets of NIST StRD nonlinear regression, fitted as impacts are: parameters, errors, intervals.

A set with one predictor x and one response y maps: x stands for St, y (over a power of ten, so that it is of the
order of a restitution) for e_eff, all of whose error is scatter. The restricted likelihood then has its maximum at
the least squares and the scatter of NIST's residual standard deviation. Only Nelson (two predictors) does not
map. Each set is fitted from NIST's starts 1 and 2 (``--start``), and without any, within bounds from a tenth of
the lesser start to ten times the greater (to both sides of zero where the sign is open). Printed are the decimal
digits that agree with the certified parameters (LRE, the least of all parameters; 11 are certified), the distance
in certified standard deviations, the ratio of our standard errors to the certified ones (theirs are of the
linearised model, J^T J, ours of the exact second derivatives), and how far the ends of the 95 % intervals are from
those of a profile made with scipy's ``least_squares`` alone, in half widths.

Data: NIST/ITL Statistical Reference Datasets (public domain; https://www.itl.nist.gov/div898/strd/), files as
shipped in NIST_STRD of the source distribution of lmfit 1.3.2 (PyPI), unchanged.

    python -m benchmarks.nist [--only TEXT] [--check]
"""

from __future__ import annotations

import argparse
import json
import re
import time
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from scipy.optimize import brentq, least_squares
from scipy.special import stdtrit

from restitution.calibration import Plan, estimate, model_of
from restitution.calibration.reading.observations import Observations
from restitution.errors import InputError
from restitution.files import write_whole
from restitution.stokes import Speed

FOLDER = Path(__file__).with_name("nist_strd")
OUT = Path(__file__).with_name("nist.json")
GAUSS = "b1*exp(-b2*St) + b3*exp(-(St - b4)**2/b5**2) + b6*exp(-(St - b7)**2/b8**2)"
LANCZOS = "b1*exp(-b2*St) + b3*exp(-b4*St) + b5*exp(-b6*St)"
CUBIC = "(b1 + b2*St + b3*St**2 + b4*St**3)/(1 + b5*St + b6*St**2 + b7*St**3)"
PI = "3.14159265358979"
MODELS = {
    "Misra1a": "b1*(1 - exp(-b2*St))",
    "Chwirut2": "exp(-b1*St)/(b2 + b3*St)",
    "Chwirut1": "exp(-b1*St)/(b2 + b3*St)",
    "Lanczos3": LANCZOS,
    "Gauss1": GAUSS,
    "Gauss2": GAUSS,
    "DanWood": "b1*St**b2",
    "Misra1b": "b1*(1 - (1 + b2*St/2)**(-2))",
    "Kirby2": "(b1 + b2*St + b3*St**2)/(1 + b4*St + b5*St**2)",
    "Hahn1": CUBIC,
    "MGH17": "b1 + b2*exp(-St*b4) + b3*exp(-St*b5)",
    "Lanczos1": LANCZOS,
    "Lanczos2": LANCZOS,
    "Gauss3": GAUSS,
    "Misra1c": "b1*(1 - (1 + 2*b2*St)**(-0.5))",
    "Misra1d": "b1*b2*St/(1 + b2*St)",
    "Roszman1": f"b1 - b2*St - atan(b3/(St - b4))/{PI}",
    "ENSO": f"b1 + b2*cos(2*{PI}*St/12) + b3*sin(2*{PI}*St/12) + b5*cos(2*{PI}*St/b4) + b6*sin(2*{PI}*St/b4) "
    f"+ b8*cos(2*{PI}*St/b7) + b9*sin(2*{PI}*St/b7)",
    "MGH09": "b1*(St**2 + St*b2)/(St**2 + St*b3 + b4)",
    "Thurber": CUBIC,
    "BoxBOD": "b1*(1 - exp(-b2*St))",
    "Rat42": "b1/(1 + exp(b2 - b3*St))",
    "MGH10": "b1*exp(b2/(St + b3))",
    "Eckerle4": "(b1/b2)*exp(-0.5*((St - b3)/b2)**2)",
    "Rat43": "b1/(1 + exp(b2 - b3*St))**(1/b4)",
    "Bennett5": "b1*(b2 + St)**(-1/b3)",
}
"""In NIST's order: lower, average, higher difficulty."""
EITHER_SIGN = {"ENSO": ("b2", "b3", "b5", "b6", "b8", "b9")}
"""Amplitudes of waves, whose sign is a phase."""
ALIKE = {LANCZOS: ((1, 2), (3, 4), (5, 6)), GAUSS: ((3, 4, 5), (6, 7, 8)), MODELS["MGH17"]: ((2, 4), (3, 5))}
"""Terms of one form: a fit may find them in another order."""


@dataclass(frozen=True)
class Certified:
    """What a file says: arrays of the parameters in order, and of the observations."""

    start_1: np.ndarray
    start_2: np.ndarray
    value: np.ndarray
    sigma: np.ndarray
    y: np.ndarray
    x: np.ndarray

    @classmethod
    def read(cls, name: str) -> Certified:
        """A file of NIST's."""
        lines = (FOLDER / f"{name}.dat").read_text("ascii").splitlines()
        table = [line.split("=")[1].split() for line in lines if re.match(r"\s*b\d+ =", line)]
        last = max(i for i, line in enumerate(lines) if line.startswith("Data:"))
        data = np.array([line.split() for line in lines[last + 1 :] if line.strip()], float)
        return cls(*np.array(table, float).T, *data.T)


def observations(c: Certified, unit: float) -> Observations:
    """The set as impacts without any stated error."""
    n, none = len(c.x), np.full(len(c.x), np.nan)
    return Observations(
        St=c.x, St_sigma=np.zeros(n), e=c.y / unit, e_sigma=np.zeros(n), correlation=np.zeros(n), upper=none,
        e_dry=none, e_dry_sigma=none, labels={"source": np.array(["NIST"] * n, object)}, convention="st",
        speed=Speed.UNSTATED, conditions=(None,) * n,
    )  # fmt: skip


def bounds_of(name: str, c: Certified) -> dict[str, tuple[float, float]]:
    """From a tenth of the lesser start to ten times the greater."""
    bounds = {}
    for k, pair in enumerate(zip(c.start_1, c.start_2, strict=True), 1):
        most = 10 * max(map(abs, pair))
        least = 0.1 * min(map(abs, pair))
        if f"b{k}" in EITHER_SIGN.get(name, ()) or min(pair) * max(pair) < 0:
            bounds[f"b{k}"] = (-most, most)
        else:
            bounds[f"b{k}"] = (least, most) if pair[0] > 0 else (-most, -least)
    return bounds


def profile_of_scipy(name: str, c: Certified, level: float = 0.95) -> np.ndarray:
    """Where the sum of squares, minimised over the others, has risen by t^2/nu of itself; (parameters, 2)."""
    model = model_of(MODELS[name], dict.fromkeys((f"b{k + 1}" for k in range(len(c.value))), (-1e9, 1e9)))
    names = [p.name for p in model.parameters]
    order = [int(n[1:]) - 1 for n in names]
    p, nu = len(order), len(c.x) - len(order)
    rise = stdtrit(nu, 0.5 * (1 + level)) ** 2 / nu

    def residual(b: np.ndarray) -> np.ndarray:
        f = model(c.x, 1.0, {n: b[k] for n, k in zip(names, order, strict=True)})[0]
        return np.nan_to_num(f - c.y, nan=1e150, posinf=1e150, neginf=-1e150)

    least = np.sum(residual(c.value) ** 2)
    ends = np.full((p, 2), np.nan)
    for j in range(p):
        others = np.arange(p) != j
        warm = {0.0: c.value[others]}

        def excess(z: float, j: int = j, others: np.ndarray = others, warm: dict = warm) -> float:
            b = c.value.copy()
            b[j] = c.value[j] + z * c.sigma[j]

            def rest(t: np.ndarray) -> np.ndarray:
                b[others] = c.value[others] + t * c.sigma[others]
                return residual(b) / np.sqrt(least)

            near = warm[min(warm, key=lambda at: abs(at - z))]
            if others.any():
                fit = least_squares(
                    rest,
                    (near - c.value[others]) / c.sigma[others],
                    method="lm",
                    xtol=1e-14,
                    ftol=1e-14,
                    gtol=1e-14,
                )
                warm[z] = b[others].copy()
                return 2 * fit.cost - 1 - rise
            return float(np.sum(rest(np.zeros(0)) ** 2)) - 1 - rise

        for side, sign in enumerate((-1.0, 1.0)):
            z = sign
            while excess(z) < 0 and abs(z) < 60:
                z += sign
            if abs(z) < 60:
                ends[j, side] = c.value[j] + c.sigma[j] * brentq(excess, z - sign, z, xtol=1e-6)
    return ends


def in_certified_order(name: str, c: Certified, values: np.ndarray, order: list[int]) -> list[int]:
    """Places of the parameters, terms of one form sorted as NIST has them (by their second parameter)."""
    terms = ALIKE.get(MODELS[name], ())
    order = list(order)
    ranked = sorted(terms, key=lambda t: values[order[t[1] - 1]])
    certified = sorted(terms, key=lambda t: c.value[t[1] - 1])
    new = list(order)
    for own, theirs in zip(ranked, certified, strict=True):
        for a, b in zip(own, theirs, strict=True):
            new[b - 1] = order[a - 1]
    return new


def one(name: str, how: str, c: Certified, reference: np.ndarray) -> dict:
    """A row of the table."""
    unit = 10.0 ** np.ceil(np.log10(np.max(np.abs(c.y))))
    bounds = bounds_of(name, c)
    text = f"({MODELS[name]})/{unit:g}"
    starts = {} if how == "own" else dict(zip(bounds, getattr(c, how).tolist(), strict=True))
    row: dict = {"set": name, "start": how}
    begun = time.process_time()
    try:
        fit = estimate(Plan(model_of(text, bounds), e_dry=1.0, starts=starts), observations(c, unit))
    except InputError as error:
        return row | {"refused": str(error)}
    best = fit.maximum
    order = [[p.name for p in best.parameters].index(b) for b in bounds]
    order = in_certified_order(name, c, best.values, order)
    value, sigma = best.values[order], best.sigma[order]
    ends = best.intervals[0.95][order]
    half = 0.5 * (reference[:, 1] - reference[:, 0])
    digits = -np.log10(np.maximum(np.abs(value / c.value - 1), 1e-16))
    return row | {
        "refused": None,
        "digits": float(min(digits.min(), 11.0)),
        "away_sigma": float(np.max(np.abs(value - c.value) / c.sigma)),
        "sigma_ratio": [float((sigma / c.sigma).min()), float((sigma / c.sigma).max())],
        "interval_ends": float(np.nanmax(np.abs(ends - reference) / half[:, None])),
        "ends_compared": int(np.isfinite(reference).sum()),
        "condition": best.condition,
        "doubts": sorted({d.name for d in fit.own_doubts}),
        "processor_s": round(time.process_time() - begun, 2),
    }


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--only", default="", help="sets whose name contains this")
    parser.add_argument("--check", action="store_true", help="print alone, write nothing")
    args = parser.parse_args()
    kept = {(r["set"], r["start"]): r for r in (json.loads(OUT.read_text()) if OUT.exists() else [])}
    print("| set | start | digits | away/sigma | sigma/certified | ends, 95 % | condition | doubts |")
    print("|---|---|---|---|---|---|---|---|")
    for name in MODELS:
        if args.only not in name:
            continue
        c = Certified.read(name)
        reference = profile_of_scipy(name, c)
        for how in ("start_1", "start_2", "own"):
            row = kept[name, how] = one(name, how, c, reference)
            print(line(row), flush=True)
        if args.check:
            continue
        rows = [kept[name, how] for name in MODELS for how in ("start_1", "start_2", "own") if (name, how) in kept]
        write_whole(OUT, json.dumps(rows, indent=1) + "\n")


def line(row: dict) -> str:
    """Of the table."""
    head = f"| {row['set']} | {row['start'].replace('_', ' ')} |"
    if row["refused"]:
        return f"{head} refused: {row['refused'][:90]} | | | | | |"
    low, high = row["sigma_ratio"]
    condition = "" if row["condition"] is None else f"{row['condition']:.0e}"
    numbers = (
        f"{row['digits']:.1f} | {row['away_sigma']:.0e} | {low:.3f} to {high:.3f} | {row['interval_ends']:.0e}"
    )
    return f"{head} {numbers} | {condition} | {', '.join(row['doubts'])} |"


if __name__ == "__main__":
    main()
