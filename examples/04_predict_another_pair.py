"""Task: predict e_eff of a pair of fluid and sphere that has not been measured, with its interval.

A law is fitted to the 3 mm sphere and to the drops of Li et al.; asked for is a 6 mm sphere in an oil ten times as
viscous. Printed: the prediction, where the law lies and where one more impact would, and what was measured there,
which the fit has not seen.
Source: Gondret, Lance & Petit, Phys. Fluids 14 (2002) 643; Li, Hunt & Colonius, J. Fluid Mech. 691 (2012) 123.
"""

from restitution import datasets
from restitution.calibration import Plan, estimate, model_of, predict, read, result_of
from restitution.conditions import Conditions, Fluid, Sphere
from restitution.impacts import find_impacts
from restitution.stokes import StokesNumber

MEASURED = ("gondret2002_st152", "li2012_drop2", "li2012_drop3", "li2012_drop5", "li2012_drop6")
LEFT_OUT = "gondret2002_st27"


def main():
    """Prediction and measurement of e_eff."""
    pair = Conditions(
        fluid=Fluid(density=965, viscosity=0.1),  # kg/m3, Pa s
        sphere=Sphere(diameter=6e-3, density=7800, e_dry=0.97),  # m, kg/m3
    )
    St = StokesNumber.from_speed(0.518, pair, speed="far")  # m/s

    result = result_of(estimate(Plan(model_of("eq4_exponential")), read(MEASURED, speed="far")))
    predicted = predict(result, St.value, conditions=pair)
    print(predicted)

    (impact,) = find_impacts(
        datasets.load_track(LEFT_OUT), datasets.resource(LEFT_OUT).conditions, speed="far"
    ).rows
    print(f"measured at St {impact['stokes']:.1f}: {impact['e_eff']:.3f} +- {impact['e_eff_sigma']:.3f}")
    return {
        "stokes": float(St.value), "e_eff": float(predicted.value[0]), "law": predicted.law["95%"][0],
        "one_impact": predicted.impact["95%"][0], "measured": impact["e_eff"], "sigma": impact["e_eff_sigma"],
    }  # fmt: skip


if __name__ == "__main__":
    main()
