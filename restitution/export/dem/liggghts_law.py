"""LIGGGHTS, level 2: a normal model whose e is that of each contact's own impact speed, as C++ source.

It is the program's own `hooke` contact, told another ln(e) for each contact; the impact speed is kept in the
contact's history. One file serves a source tree (put into src/ and compiled with the rest) and a program installed
with its headers (compiled alone as a library that is loaded before the program).
"""

from __future__ import annotations

from restitution.export.dem import at_impact
from restitution.export.dem.snippet import Request, comments
from restitution.export.impacts import Impacts

IDENTITY = 61
"""Of the model among the program's normal models, below 64; those of PUBLIC 3.8.0 are below 20."""
_SOURCE = """
#ifdef NORMAL_MODEL
NORMAL_MODEL({upper}, {style}, {identity})
#else
#ifndef NORMAL_MODEL_{upper}_H_
#define NORMAL_MODEL_{upper}_H_

#include "global_properties.h"
#ifdef LOADED_LIBRARY
#include "fix_insert_stream.h"
#include "granular_styles.h"
#else
#include "contact_models.h"
#include "normal_model_base.h"
#include "normal_model_hooke.h"
#endif
{functions}
namespace LIGGGHTS {{
namespace ContactModels {{
#ifdef LOADED_LIBRARY
static const int {upper} = {identity};
#endif

template<>
class NormalModel<{upper}> : public NormalModel<HOOKE>
{{
  public:
    NormalModel(LAMMPS *lmp, IContactHistorySetup *history, ContactModelBase *contact) :
        NormalModel<HOOKE>(lmp, history, contact), impact_(-1) {{}}

    void postSettings(IContactHistorySetup *history, ContactModelBase *contact)
    {{
        NormalModel<HOOKE>::postSettings(history, contact);
        if (viscous)
            error->all(FLERR, "{style} has the viscous loss in its law: no 'viscous on'");
        impact_ = history->add_history_value("impact_speed", "0");
    }}

    void surfacesIntersect(SurfacesIntersectData &contact, ForceData &i_forces, ForceData &j_forces)
    {{
        double &impact = contact.contact_history[impact_];
        // vn < 0 on approach; never 0, which says that there is no contact yet
        if (impact == 0.0)
            impact = contact.vn < -1e-300 ? -contact.vn : 1e-300;
        const double e = restitution(impact, contact);
        coeffRestLog[contact.itype][contact.jtype] = log(e > {least!r} ? e : {least!r});
        NormalModel<HOOKE>::surfacesIntersect(contact, i_forces, j_forces);
    }}

    void surfacesClose(SurfacesCloseData &contact, ForceData &i_forces, ForceData &j_forces)
    {{
        if (contact.contact_history)
            contact.contact_history[impact_] = 0.0;
        NormalModel<HOOKE>::surfacesClose(contact, i_forces, j_forces);
    }}

  private:
    static double density(double mass, double d) {{ return mass/(M_PI/6*d*d*d); }}

    static double restitution(double v, const SurfacesIntersectData &contact)
    {{
{numbers}        const double d_1 = 2*contact.radi, rho_1 = density(contact.mi, d_1);
        if (contact.is_wall)
            return {wall};
        const double d_2 = 2*contact.radj, rho_2 = density(contact.mj, d_2);
        return {pair};
    }}

    int impact_;
}};
}}
}}

#ifdef LOADED_LIBRARY
namespace {{
using namespace LIGGGHTS;

template<class Contact>
PairStyles::IGranularPairStyle *new_pair(LAMMPS *lmp, PairGran *parent, const int64_t hash)
{{
    return new PairStyles::Granular<Contact>(lmp, parent, hash);
}}

template<class Contact>
Walls::IGranularWall *new_wall(LAMMPS *lmp, FixWallGran *parent, const int64_t hash)
{{
    return new Walls::Granular<Contact>(lmp, parent, hash);
}}

template<int TANGENTIAL>
void add()
{{
    typedef ContactModels::GranStyle<ContactModels::{upper}, TANGENTIAL, 0, 0, 0> Style;
    typedef ContactModels::ContactModel<Style> Contact;
    PairStyles::Factory::instance().addStyle("gran", Style::HASHCODE, new_pair<Contact>);
    Walls::Factory::instance().addStyle("gran", Style::HASHCODE, new_wall<Contact>);
}}

struct AtStart
{{
    AtStart()
    {{
        ContactModels::Factory::instance().addNormalModel("{style}", ContactModels::{upper});
        add<TANGENTIAL_OFF>();
        add<TANGENTIAL_NO_HISTORY>();
        add<TANGENTIAL_HISTORY>();
    }}
}} at_start;
}}
#endif
#endif
#endif
"""
HEADERS = "/usr/include/liggghts"
"""Where the development package of Debian has them."""
STYLE_FILES = {
    "surface": ("default",),
    "normal": ("hooke",),
    "tangential": ("no_history", "history"),
    "cohesion": (),
    "rolling": (),
}
"""The lists of models that a source tree makes for itself and the package of headers lacks."""


def style_file(kind: str) -> str:
    """The content of one of them."""
    return "".join(f'#include "{kind}_model_{name}.h"\n' for name in STYLE_FILES[kind])


def compile_command(source: str, library: str) -> list[str]:
    """How a loaded library is compiled, the lists of models being in the folder."""
    program = "-l:libliggghts.so.3"
    flags = ["-shared", "-fPIC", "-w", "-O2", "-DLOADED_LIBRARY", "-I.", f"-I{HEADERS}"]
    return ["mpicxx", *flags, "-x", "c++", source, "-o", library, program]


def style_of(impacts: Impacts) -> str:
    """The name of the model in an input script."""
    return f"hooke/{impacts.closure.name}"


def liggghts_law(impacts: Impacts, request: Request, version: str) -> str:
    """The C++ header of the normal model."""
    name, style = impacts.closure.name, style_of(impacts)
    file = f"normal_model_{name}.h"
    lists = "; ".join(
        " ".join(
            [
                "printf",
                "'" + style_file(kind).replace("\n", "\\n") + "'",
                f"> style_{kind}_model.h",
            ]
        )
        for kind in STYLE_FILES
    )
    said = [
        *at_impact.level_2_lines(impacts),
        f"save as {file}. In an input script: pair_style gran model {style}, and the same in fix wall/gran; the "
        "keywords of hooke hold, coefficientRestitution must be given and is not used. Not limitForce on: the "
        "contact may pull at its end, so that e asked is e delivered",
        "with a source tree (also of CFDEMcoupling): put it into src/ and compile as always. Compiled in that "
        "arrangement against the headers of 3.8.0, not linked",
        "with Debian's liggghts, libliggghts-dev and libopenmpi-dev: a library loaded before the program, for "
        "tangential off, no_history and history, no cohesion, no rolling; tried. In an empty folder:",
        f"   {lists}; touch style_contact_model.h",
        f"   {' '.join(compile_command(file, f'{name}.so'))}",
        f"   LD_PRELOAD=./{name}.so liggghts -in in.yours (mpirun: -x LD_PRELOAD=...)",
        "no lubrication model beside it: e_eff holds the viscous loss already. Time step: contact time/50",
    ]
    fluid = at_impact.fluid_numbers(impacts)
    names = ("v", "d_1", "rho_1", "d_2", "rho_2", *fluid)
    of = {n: n for n in names} | {"d": "d_1", "rho_p": "rho_1"}
    heading = comments(impacts, "LIGGGHTS, C++", version, said, "//")
    return heading + _SOURCE.format(
        upper=name.upper(),
        style=style,
        identity=IDENTITY,
        functions="\n" + at_impact.functions(impacts, "c"),
        least=at_impact.LEAST_E,
        numbers="".join(f"        const double {n} = {value!r};\n" for n, value in fluid.items()),
        wall=at_impact.restitution_call(impacts, of, pair=False),
        pair=at_impact.restitution_call(impacts, of, pair=True),
    )
