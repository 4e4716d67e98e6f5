"""What errors of St do to the parameters: the bias of a fit under several processes of error.

Forty impacts of the law of ``benchmarks.coverage`` with errors of St of 5 %, fitted without scatter. St may be
read with an error proportional to it or with one in its logarithm, the error may be quoted in proportion to the
value read or to the true one, and true St may be spread evenly in the logarithm or in St itself. The last line
leaves out ln var_i of the likelihood, the last but one the errors of St.

    python -m benchmarks.stokes_error_bias [--sets 600]
"""

from __future__ import annotations

import argparse
from dataclasses import dataclass, replace

import numpy as np

from benchmarks.coverage import E_DRY, E_SIGMA, Case, K, draw
from restitution.calibration import Plan, model_of
from restitution.calibration.estimation.likelihood import Likelihood
from restitution.calibration.estimation.maximum import maximise

N, ERROR = 40, 0.05


@dataclass(frozen=True)
class Process:
    """How St comes to be read, and its error to be quoted."""

    name: str
    logarithmic: bool = False
    quoted_by_true: bool = False
    uniform: bool = False
    quoted: bool = True
    log_variance: bool = True


PROCESSES = (
    Process("St (1 + 0.05 z), 5 % of St read"),
    Process("St (1 + 0.05 z), 5 % of true St", quoted_by_true=True),
    Process("St exp(0.05 z), 5 % of St read", logarithmic=True),
    Process("the first, true St uniform", uniform=True),
    Process("the first, errors of St ignored", quoted=False),
    Process("the first, without ln var_i", log_variance=False),
)


def likelihood(process: Process, seed: int) -> Likelihood:
    """That of one set of impacts."""
    rng = np.random.default_rng([7, seed])
    St = rng.uniform(15, 500, N) if process.uniform else np.exp(rng.uniform(np.log(15), np.log(500), N))
    z = rng.standard_normal(N)
    e = E_DRY * np.exp(-K * (1 + E_DRY) / St) + E_SIGMA * rng.standard_normal(N)
    read = St * np.exp(ERROR * z) if process.logarithmic else St * (1 + ERROR * z)
    sigma = ERROR * (St if process.quoted_by_true else read) * process.quoted
    observations = replace(draw(Case("impacts"), N, seed), St=read, St_sigma=sigma, e=e)
    plan = Plan(model_of("eq4_exponential"), e_dry="free", scatter=False)
    return replace(plan.likelihood(observations), log_variance=process.log_variance)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--sets", type=int, default=600)
    sets, truth = parser.parse_args().sets, np.array([K, E_DRY])
    print(f"bias over standard error, K / e_dry, uncertain by {sets**-0.5:.2f}; bias of K")
    for process in PROCESSES:
        found = []
        for seed in range(sets):
            function = likelihood(process, seed)
            found.append(maximise(function, function.parameters, truth, covariance=False).values - truth)
        error, spread = np.mean(found, axis=0), np.std(found, axis=0, ddof=1)
        ratio = " / ".join(f"{x:5.2f}" for x in error / spread)
        print(f"{process.name:36} {ratio} {100 * error[0] / K:+8.2f} %", flush=True)


if __name__ == "__main__":
    main()
