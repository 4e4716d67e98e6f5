"""The observations of a fit: one impact an element, measured or censored, with errors, labels and provenance."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from restitution.calibration.reading.shared_errors import joined
from restitution.calibration.showing import Showing, Table, counted
from restitution.conditions import Conditions
from restitution.doubts import Doubt
from restitution.errors import ConventionError, Defect, InputError
from restitution.stokes import H_FILM, Speed, StokesNumber, film_edge

if TYPE_CHECKING:
    import pandas as pd


WITHOUT_REBOUND = ("no_rebound", "not_resolved")
"""Outcomes of an impact of which e_eff is known to a limit only."""
_GROUPS = ("material", "record")
"""Columns that become labels where a table has them, beside the source."""
_TEXTS = ("source", *_GROUPS, "kind", "outcome", "speed_definition", "stokes_convention")
_NUMBERS = (
    "stokes", "stokes_sigma", "e_dry", "e_dry_sigma", "e_eff", "e_eff_sigma", "e_stokes_correlation",
    "e_eff_upper", "film_edge_d",
)  # fmt: skip


@dataclass(frozen=True, repr=False)
class Observations(Showing):
    """Arrays of length n, one element an impact.

    ``e`` is NaN where no rebound was seen; then e_eff was at most ``upper`` (NaN elsewhere). ``e_sigma`` is zero
    where no error is known: the scatter that is estimated then has it. ``correlation`` is that of the errors of e
    and St. ``e_dry`` and ``e_dry_sigma`` are NaN where nobody states them. ``labels`` has one text an impact for
    each way of grouping: ``source``, ``material``, ...
    """

    St: NDArray
    St_sigma: NDArray
    e: NDArray
    e_sigma: NDArray
    correlation: NDArray
    upper: NDArray
    e_dry: NDArray
    e_dry_sigma: NDArray
    labels: Mapping[str, NDArray]
    convention: str
    speed: Speed
    conditions: tuple[Conditions | None, ...]
    edge: float | None = None
    """Of the film in diameters, outside which the speeds are those of the motion; of the speed ``far`` alone."""
    places: tuple[tuple[str, int], ...] = ()
    """File and row of each impact."""
    files: Mapping[str, str] = field(default_factory=dict)
    """sha256 of each file."""
    notes: tuple[str, ...] = ()
    doubts: tuple[Doubt, ...] = ()
    """About the records that they come from."""
    shared: NDArray | None = None
    """Loadings (n, 2, m) of the errors of St and of e on those of their record (:mod:`.shared_errors`)."""
    simulated: bool = False
    """Whether they come from a simulation; such ones are never joined with measured ones."""

    @classmethod
    def from_impacts(
        cls,
        rows: pd.DataFrame | Iterable[Mapping[str, Any]],
        conditions: Conditions | Sequence[Conditions | None] | None = None,
        *,
        places: tuple[tuple[str, int], ...] = (),
        files: Mapping[str, str] | None = None,
        notes: tuple[str, ...] = (),
        doubts: tuple[Doubt, ...] = (),
    ) -> Observations:
        """Impacts in the columns of the impact table, as :func:`restitution.impacts.find_impacts` gives them.

        Needed are ``stokes``, ``stokes_convention``, ``speed_definition``, and ``e_eff`` or an ``outcome`` without
        rebound; ``source`` is the ``record`` where it is not given. ``conditions`` are those of all impacts or of
        each. A limit has no error of its own, nor has an impact that states none: that of a typical one is taken.
        """
        import pandas as pd

        table = pd.DataFrame(rows)
        # A text column that the rows lack would be one of numbers, and take no text in its place.
        table = table.reindex(columns=[*_TEXTS, *_NUMBERS]).astype(dict.fromkeys(_TEXTS, object))
        n = len(table)
        per_row = (conditions,) * n if isinstance(conditions, Conditions | None) else tuple(conditions)

        def numbers(name: str) -> NDArray:
            return table[name].to_numpy(float)

        none = table["outcome"].isin(WITHOUT_REBOUND).to_numpy(bool)
        e_sigma, correlation, e_dry = numbers("e_eff_sigma"), numbers("e_stokes_correlation"), numbers("e_dry")
        known = e_sigma[~none & np.isfinite(e_sigma)]
        e_sigma = np.where(np.isfinite(e_sigma), e_sigma, np.median(known) if len(known) else 0.0)
        stated = np.array([np.nan if c is None or c.sphere.e_dry is None else c.sphere.e_dry for c in per_row])
        labels = {"source": table["source"].fillna(table["record"]).fillna("").to_numpy(object)}
        labels |= {name: table[name].fillna("").to_numpy(object) for name in _GROUPS if table[name].notna().any()}
        return cls(
            St=numbers("stokes"),
            St_sigma=np.nan_to_num(numbers("stokes_sigma")),
            e=np.where(none, np.nan, numbers("e_eff")),
            e_sigma=e_sigma,
            correlation=np.where(np.isnan(correlation) | (e_sigma == 0), 0.0, correlation),
            upper=np.where(none, np.nan_to_num(numbers("e_eff_upper")), np.nan),
            e_dry=np.where(np.isnan(e_dry), stated, e_dry),
            e_dry_sigma=numbers("e_dry_sigma"),
            labels=labels,
            convention=_the_one(table["stokes_convention"]),
            speed=Speed(_the_one(table["speed_definition"])),
            simulated=_the_one(table["kind"].fillna("measured")) == "simulated",
            conditions=per_row,
            edge=_edge(table),
            places=places,
            files=dict(files or {}),
            notes=notes,
            doubts=doubts,
        )

    def shown(self) -> Table:
        """How many impacts of which source, and what their numbers are."""
        sources, group = self.groups("source")
        rows = []
        for i, name in enumerate(sources):
            here, seen = self.St[group == i], ~self.censored[group == i]
            rows.append((name, f"{seen.sum()}", f"{(~seen).sum()}", f"{here.min():.3g} to {here.max():.3g}"))
        kind = "simulated impact" if self.simulated else "impact"
        edge = f", edge of the film {self.edge:g} d" if self.edge is not None else ""
        title = f"{counted(len(self), kind)}, Stokes number {self.convention}, impact speed {self.speed}{edge}"
        return Table(title, ("source", "with a rebound", "without", "St"), rows)

    def __len__(self) -> int:
        return len(self.St)

    @property
    def censored(self) -> NDArray:
        """Where no rebound was seen."""
        return np.isnan(self.e)

    def take(self, which: NDArray) -> Observations:
        """Those impacts alone; ``which`` is a mask or indices."""
        index = np.arange(len(self))[which]
        arrays = {
            f.name: getattr(self, f.name)[index]
            for f in dataclasses.fields(self)
            if isinstance(getattr(self, f.name), np.ndarray)
        }
        return dataclasses.replace(
            self,
            **arrays,
            labels={name: values[index] for name, values in self.labels.items()},
            conditions=tuple(self.conditions[i] for i in index),
            places=tuple(self.places[i] for i in index) if self.places else (),
        )

    def place(self, i: int) -> dict[str, Any]:
        """File and row of impact ``i``, as a defect names them; nothing of impacts that come from no file."""
        return dict(zip(("file", "row"), self.places[i], strict=True)) if self.places else {}

    def ratio_to(self, convention: str) -> NDArray:
        """St of another convention over the St here, impact by impact; raises where conditions are needed."""
        known: dict[int, float] = {}
        ratio = np.empty(len(self))
        for i, conditions in enumerate(self.conditions):
            key = id(conditions)
            if key not in known:
                try:
                    known[key] = StokesNumber(1.0, self.convention, self.speed).to(convention, conditions).value
                except ConventionError as error:
                    columns = "fluid_density_kg_m3, fluid_viscosity_Pa_s, sphere_diameter_m, sphere_density_kg_m3"
                    rule = f"{error} (the columns {columns}, or --conditions FILE)"
                    raise ConventionError(Defect(rule, **self.place(i))) from None
            ratio[i] = known[key]
        return ratio

    def groups(self, label: str) -> tuple[list[str], NDArray]:
        """The levels of a label in order of appearance, and the index of each impact's level."""
        if label not in self.labels:
            known = ", ".join(self.labels) or "none"
            raise InputError(Defect(f"is not a column that groups the impacts; there are: {known}", field=label))
        levels = list(dict.fromkeys(self.labels[label]))
        return levels, np.array([levels.index(x) for x in self.labels[label]], int)


def correlation_of_independent_speeds(e: NDArray, e_sigma: NDArray, St: NDArray, St_sigma: NDArray) -> NDArray:
    """Of the errors of e = v_out/v_in and of St where those of v_in and v_out are independent.

    The error of v_in moves both: rho sigma_e sigma_St = -e sigma_St^2/St.
    """
    return -e * St_sigma / (St * e_sigma)


def _the_one(column: pd.Series) -> str:
    """The one value of a column that states a definition."""
    stated = column.unique()
    if len(stated) != 1:
        values = ", ".join(map(str, stated)) or "none"
        raise InputError(Defect(f"must be one for all impacts; there are: {values}", field=str(column.name)))
    return str(stated[0])


def _edge(table: pd.DataFrame) -> float | None:
    """The one edge of the film of impacts under the speed ``far``; where they state none that of the package."""
    if _the_one(table["speed_definition"]) != Speed.FAR:
        return None
    return film_edge(float(_the_one(table["film_edge_d"].fillna(H_FILM))), "film_edge_d")


def _converted(o: Observations, key: str) -> Observations:
    """The same impacts under another definition of the Stokes number; some need fluid and sphere for that."""
    if o.convention == key:
        return o
    file = next(iter(o.files), None)
    try:
        ratio = np.array([StokesNumber(1.0, o.convention).to(key, c).value for c in o.conditions], float)
    except InputError as error:
        rule = f"{error}: --conditions FILE, or columns of fluid and sphere"
        raise InputError(Defect(rule, file=file, field="stokes_convention", value=o.convention)) from None
    note = f"{file or 'impacts'}: Stokes numbers converted from {o.convention} to {key}"
    shared = o.shared if o.shared is None else o.shared * np.stack([ratio, np.ones(len(o))], axis=1)[:, :, None]
    return dataclasses.replace(
        o, St=o.St * ratio, St_sigma=o.St_sigma * ratio, convention=key, shared=shared, notes=(*o.notes, note)
    )


def join(parts: list[Observations]) -> Observations:
    """All observations of several files, in the Stokes number of the first; raises where impact speeds differ."""
    first = parts[0]
    parts = [first, *(_converted(other, first.convention) for other in parts[1:])]
    for other in parts[1:]:
        if other.simulated != first.simulated:
            kinds = ["measured", "simulated"]
            here, there = kinds[other.simulated], kinds[first.simulated]
            rule = f"has {here} impacts, the first file {there} ones: fit them apart"
            raise InputError(Defect(rule, file=next(iter(other.files), None), field="kind"))
        if other.speed != first.speed:
            rule = f"speed differs from {first.speed} of {next(iter(first.files), 'the first file')}"
            file = next(iter(other.files), None)
            raise InputError(Defect(f"{rule}: fit data of one definition", file=file, value=str(other.speed)))
        if other.edge != first.edge:
            rule = (
                f"has the film end at {other.edge:g} d, {next(iter(first.files), 'the first file')} at "
                f"{first.edge:g} d: e_eff of different edges are different quantities; fit data of one"
            )
            raise InputError(Defect(rule, file=next(iter(other.files), None), field="film_edge_d"))
    names = dict.fromkeys(name for part in parts for name in part.labels)
    labels = {
        name: np.concatenate([p.labels.get(name, np.full(len(p), "", object)) for p in parts]) for name in names
    }
    arrays = {
        f.name: np.concatenate([getattr(p, f.name) for p in parts])
        for f in dataclasses.fields(first)
        if isinstance(getattr(first, f.name), np.ndarray) and f.name != "shared"
    }
    return dataclasses.replace(
        first,
        **arrays,
        shared=joined([(len(p), p.shared) for p in parts]),
        labels=labels,
        conditions=tuple(c for p in parts for c in p.conditions),
        places=tuple(x for p in parts for x in p.places),
        files={name: digest for p in parts for name, digest in p.files.items()},
        notes=tuple(dict.fromkeys(note for p in parts for note in p.notes)),
        doubts=tuple(dict.fromkeys(doubt for p in parts for doubt in p.doubts)),
    )
