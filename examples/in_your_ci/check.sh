#!/bin/sh
# Did this change spoil my solver? Plain shell, for any CI: exit status 0 as it was, 1 worse, 2 unusable, 3 not evaluated.
set -eu
# RESTITUTION: a wheel or a checkout of this package. What fails before the score is unusable, not worse.
{ python3 -m venv .check && .check/bin/pip install --quiet "$RESTITUTION" && rm -f track.csv; } || exit 2
./my_solver --case cases/gondret_st152.xml --out track.csv || exit 2   # yours: columns t in s, gap in m
.check/bin/restitution validate --trajectory track.csv --case gondret-st152 --grid-error 0.03 \
    --column time_s=t --column gap_m=gap --unit m --time-unit s --direction up --out check
# A change of the closures or the lattice of this package itself:
#   restitution validate --depth quick --out check
