"""The areas, in the order of the table, with what revision 0a77d89 came to."""

from __future__ import annotations

import signal

from benchmarks.soak import (
    cases,
    exports,
    fits,
    fitting,
    flights,
    impacts,
    kills,
    packages,
    places,
    runs,
    sweeps,
    tracks,
)
from benchmarks.soak.outcome import Area

AREAS = (
    Area("kills of simulate at random", (24, 22, 0, 0, 2, 0), kills.simulations((signal.SIGKILL,
        signal.SIGTERM), 1)),
    Area("Ctrl-C of simulate, one to three", (12, 9, 0, 0, 3, 0), kills.simulations((signal.SIGINT,), 3)),
    Area("kills of fit --out --report at random", (9, 9, 0, 0, 0, 0), kills.at_random(kills.FIT, 15)),
    Area("kills placed inside the writing", (4, 0, 0, 0, 4, 0), kills.placed, slow=True),
    Area("kills of report fig1 at random", None, kills.at_random(kills.FIG1, 90), slow=True),
    Area("kills of report fig2 at random", None, kills.at_random(kills.FIG2, 90), slow=True),
    Area("kills of validate at random", None, kills.at_random(kills.VALIDATE, 30), slow=True),
    Area("kills of sweep at random", None, sweeps.stops, slow=True),
    Area("disk full, limits, kinds of output", (41, 40, 1, 0, 0, 0), places.full_disks),
    Area("kernel cache, thread variables", (19, 14, 2, 0, 2, 1), places.threads),
    Area("two processes on one --out, cold cache", (3, 2, 0, 0, 1, 0), kills.at_once),
    Area("checkpoint.h5 cut", (20, 20, 0, 0, 0, 0), runs.cut),
    Area("checkpoint.h5, one bit flipped", (20, 20, 0, 0, 0, 0), runs.flipped),
    Area("checkpoint edited, swapped, bombs", (26, 14, 8, 0, 4, 0), runs.edited),
    Area("flow.npz damaged", (11, 0, 11, 0, 0, 0), runs.pictures),
    Area("kept runs: tables cut, run.json edited", (42, 17, 4, 0, 21, 0), runs.kept),
    Area("camera tracks", (59, 58, 0, 0, 1, 0), tracks.tracks),
    Area("paths (names, links, pipes, devices)", (16, 13, 1, 0, 0, 2), places.paths),
    Area("conditions TOML", (36, 27, 5, 1, 3, 0), tracks.conditions),
    Area("case TOML (simulate, bounce)", (60, 47, 9, 0, 3, 1), cases.cases),
    Area("impacts tables", (35, 31, 2, 1, 1, 0), impacts.impact_tables),
    Area("digitizer JSON and CSV", (42, 34, 4, 0, 2, 2), impacts.digitized),
    Area("fit.json through predict, design", (75, 11, 12, 0, 37, 15), fitting.fit_files),
    Area("predict options", (14, 10, 0, 0, 4, 0), fitting.predict_options),
    Area("formulas (--law)", (82, 82, 0, 0, 0, 0), fitting.formulas),
    Area("--bounds, other fit options", (35, 29, 2, 0, 4, 0), fitting.fit_options),
    Area("data packages, schemas", (52, 44, 2, 0, 6, 0), packages.packages),
    Area("fits: points, sigmas, censoring", (27, 26, 0, 0, 1, 0), fits.points),
    Area("simulations: densities, sizes, drive", (35, 33, 0, 0, 2, 0), fits.simulations),
    Area("same bytes in any environment", (39, 39, 0, 0, 0, 0), places.same_bytes),
    Area("exports of laws and cases", None, exports.exports),
    Area("scores (validate --trajectory)", None, flights.trajectories),
    Area("settings of tracks", None, flights.settings),
    Area("fits of flights: prior, start, release", None, flights.whole_flights),
    Area("sweeps", None, sweeps.sweeps),
    Area("closed and full pipes", (7, 7, 0, 0, 0, 0), places.pipes_out),
)  # fmt: skip
