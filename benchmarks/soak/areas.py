"""The areas, in the order of the table, with what revision 0a77d89 came to."""

from __future__ import annotations

from benchmarks.soak import texts
from benchmarks.soak.outcome import Area

AREAS = (
    Area("camera tracks", (59, 58, 0, 0, 1, 0), texts.tracks),
    Area("conditions TOML", (36, 27, 5, 1, 3, 0), texts.conditions),
    Area("case TOML (simulate, bounce)", (60, 47, 9, 0, 3, 1), texts.cases),
    Area("impacts tables", (35, 31, 2, 1, 1, 0), texts.impact_tables),
    Area("digitizer JSON and CSV", (42, 34, 4, 0, 2, 2), texts.digitized),
    Area("fit.json through predict, design", (75, 11, 12, 0, 37, 15), texts.fit_files),
    Area("predict options", (14, 10, 0, 0, 4, 0), texts.predict_options),
    Area("formulas (--law)", (82, 82, 0, 0, 0, 0), texts.formulas),
    Area("--bounds, other fit options", (35, 29, 2, 0, 4, 0), texts.fit_options),
    Area("data packages, schemas", (52, 44, 2, 0, 6, 0), texts.packages),
)
