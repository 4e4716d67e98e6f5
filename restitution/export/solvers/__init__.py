"""Texts for flow solvers, written from their sources and manuals and not tried.

:mod:`.openfoam`: e_eff at walls, for parcels whose film is not resolved. :mod:`.contacts`: lines for MFIX and
OpenLB. :mod:`.film_codes`: keys for codes with a film of their own (waLBerla, Lethe, LIGGGHTS-PFM, MFC), which
take e_dry and a least gap, never e_eff; :mod:`.case_files`: whole input files of two of them for a case.
"""

from restitution.export.solvers.case_files import CASE_TARGETS, case_file
from restitution.export.solvers.contacts import mfix, openlb
from restitution.export.solvers.film_codes import FILM_CODES, FilmRequest, film_code
from restitution.export.solvers.openfoam import openfoam

__all__ = [
    "CASE_TARGETS",
    "FILM_CODES",
    "FilmRequest",
    "case_file",
    "film_code",
    "mfix",
    "openfoam",
    "openlb",
]
