"""OpenFOAM: e_eff where a parcel meets a wall, as dictionary entries or as a patch interaction model in C++.

The parcel is a point: its film is not resolved, so e_eff, not e_dry, belongs there. Both libraries multiply the
normal velocity relative to the wall by e.
"""

from __future__ import annotations

from restitution.export.dem import at_impact
from restitution.export.dem.snippet import Request, check_level, comments, constant_of, range_lines
from restitution.export.heading import NOT_TRIED
from restitution.export.impacts import Impacts

VERSION = "dev of 2026 and a copy of .com, from their sources"
_MODEL = """
#ifndef {guard}
#define {guard}

#include "PatchInteractionModel.H"
{functions}
namespace Foam
{{

template<class CloudType>
class {name}
:
    public PatchInteractionModel<CloudType>
{{
public:

    TypeName("{name}");

    {name}(const dictionary& dict, CloudType& cloud)
    :
        PatchInteractionModel<CloudType>(dict, cloud, typeName)
    {{}}

    {name}(const {name}<CloudType>& model)
    :
        PatchInteractionModel<CloudType>(model)
    {{}}

    virtual autoPtr<PatchInteractionModel<CloudType>> clone() const
    {{
        return autoPtr<PatchInteractionModel<CloudType>>(new {name}<CloudType>(*this));
    }}

    virtual ~{name}()
    {{}}

    virtual bool correct(typename CloudType::parcelType& p, const polyPatch& pp, bool& keepParticle)
    {{
        keepParticle = true;
        vector normal, wall;
        this->owner().patchData(p, pp, normal, wall);
        const scalar v = (p.U() - wall) & normal;  // outwards: towards the wall
        if (v > 0)
        {{
{numbers}            const scalar d = p.d(), rho_p = p.rho();
            p.U() -= (1 + {call})*v*normal;
        }}
        return true;
    }}
}};

}}

#endif
"""


def openfoam(impacts: Impacts, request: Request) -> str:
    """Dictionary entries of level 0, or a class of level 2."""
    check_level(request, "openfoam", (0, 2))
    return _entries(impacts, request) if request.level == 0 else _class(impacts, request)


def _entries(impacts: Impacts, request: Request) -> str:
    constant = constant_of(impacts, request)
    said = [
        "tried: the first form with OpenFOAM 1912 of Debian, parcels without force; the second was not",
        *range_lines(impacts, constant),
        "for point parcels, in constant/kinematicCloudProperties (or the cloud's own); of the newer library of "
        "OpenFOAM dev in the patch of the velocity U of the cloud. Sliding: mu = 0, none is lost",
        "no collision model that damps the same impact, no lubrication",
    ]
    e = f"{constant.e:.9g}"
    text = comments(impacts, "OpenFOAM, dictionary", VERSION, said, "//")
    text += "\npatchInteractionModel localInteraction;\nlocalInteractionCoeffs  // dev: localInteraction\n{\n"
    text += f"    patches\n    (\n        walls {{ type rebound; e {e}; mu 0; }}\n    );\n}}\n"
    return text + (
        "\n// newer Lagrangian library of OpenFOAM dev: boundaryField of the cloud's U\n"
        f"walls\n{{\n    type    reboundVelocity;\n    e       {e};\n    mu      0;\n}}\n"
    )


def _class(impacts: Impacts, request: Request) -> str:
    name = "".join(part.capitalize() for part in impacts.closure.name.split("_")) + "Interaction"
    said = [
        NOT_TRIED + ". The class was compiled and run against stand-ins for what it takes of OpenFOAM",
        *at_impact.level_2_lines(impacts, dashpot=False),
        f"save as {name}.H: a patch interaction model of the library lagrangian/parcel (dev) or "
        "lagrangian/intermediate (.com). In a library of your own, compiled by wmake:",
        f'   #include "basicKinematicCloud.H"  // dev: momentumCloud; then #include "{name}.H"',
        f"   namespace Foam {{ makePatchInteractionModelType({name}, basicKinematicCloud); }}",
        f"then libs (...) in controlDict, and patchInteractionModel {name}; without coefficients",
        "every wall patch rebounds; sliding is not damped. St and e take the parcel's own d and rho",
    ]
    fluid = at_impact.fluid_numbers(impacts)
    of = {n: n for n in ("v", "d", "rho_p", *fluid)}
    return comments(impacts, "OpenFOAM, C++", VERSION, said, "//") + _MODEL.format(
        guard=f"{name}_H",
        name=name,
        functions="\n" + at_impact.functions(impacts, "c"),
        numbers="".join(f"            const scalar {n} = {value!r};\n" for n, value in fluid.items()),
        call=at_impact.restitution_call(impacts, of, pair=False),
    )
