"""Task: a rebound law of one's own, typed as a formula, fitted and compared with two shipped ones.

Printed: the parameters of the formula with their intervals; the three laws ranked by predicting each impact from
the others, and whether the data tell them apart.
Source: impacts of three records of steel spheres (Gondret et al. 2002, Li et al. 2012).
"""

from restitution.calibration import Plan, estimate, model_of, rank, read, result_of

RECORDS = ("gondret2002_st152", "li2012_drop3", "li2012_drop6")
FORMULA = "e_dry*exp(-(a/St)**n)"  # n = 1: the exponential reading of Eq. (4), a = K (1 + e_dry)


def main():
    """The exponent with its interval, the log-likelihood of each law and which are told from the best."""
    impacts = read(RECORDS, speed="far")
    own = Plan(model_of(FORMULA, bounds={"a": (1, 200), "n": (0.3, 3)}, convention="st"))
    result = result_of(estimate(own, impacts))
    print(result)

    shipped = [(name, Plan(model_of(name))) for name in ("eq4_exponential", "legendre_2005")]
    ranking = rank([("my own", own), *shipped], impacts)
    print(ranking)
    n = next(p for p in result.parameters if p.name == "n")
    return {
        "n": n.value,
        "interval": n.intervals["95%"],
        "log_likelihood": {score.label: score.log_likelihood for score in ranking.scores},
        "told_apart": [row.law for row in ranking.rows() if row.separated],
    }


if __name__ == "__main__":
    main()
