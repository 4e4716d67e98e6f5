"""Relaxation rates of the moments, with presets named after their source.

Viscosities follow from d'Humieres et al. (2002), with c_s^2 = 1/3::

    nu = (1/s_nu - 1/2)/3          (shear)
    zeta = 2/9 (1/s_e - 1/2)       (bulk)
"""

from __future__ import annotations

from dataclasses import dataclass, fields, replace

import numpy as np

from lbm import arguments
from lbm.errors import InputError

__all__ = ["PRESETS", "Rates"]

_FINER = "raise the viscosity in lattice units (more cells or a higher lattice speed)"
_COARSER = "lower the viscosity in lattice units (fewer cells or a lower lattice speed)"

_FAST = 0.3
"""Slowest s_m with which flows of high grid Reynolds number were shown to be stable."""
_SLOWER = 0.2
"""(1/s_nu - 1/2)(1/s_q - 1/2) above which q is slower than two relaxation times have it (3/16)."""
_AT_ONCE = 1.0
"""s_q and s_m from which on odd moments relax within a step or two."""
_UNDAMPED = 1.5
"""s_e and s_pi beyond which even moments overshoot, as all of them do with one rate at low viscosity."""


def _rate(viscosity: float, factor: float, name: str) -> float:
    rate = 1.0 / (arguments.positive(f"{name} in lattice units", viscosity) / factor + 0.5)
    if rate == 2:
        raise InputError(f"{name} = {viscosity:g} in lattice units: too low for double precision; {_FINER}")
    return rate


@dataclass(frozen=True)
class Rates:
    """Relaxation rates of the moments of :mod:`lbm.fluid.moments`, per step, each in (0, 2).

    Parameters
    ----------
    nu : of the stress p; sets the shear viscosity.
    e : of the energy; sets the bulk viscosity.
    eps : of the energy square.
    q : of the energy flux.
    pi : of the fourth-order stress.
    m : of the third-order antisymmetric moments.

    Raises
    ------
    InputError
        For a rate outside (0, 2), or a viscosity that leads there.

    Notes
    -----
    The presets take the viscosity in lattice units, cells^2 a step.
    """

    nu: float
    e: float
    eps: float
    q: float
    pi: float
    m: float

    def __post_init__(self) -> None:
        for field in fields(self):
            value = arguments.number(f"relaxation rate s_{field.name}", getattr(self, field.name))
            if not 0 < value < 2:
                mend = f"; {_COARSER if value <= 0 else _FINER}" if field.name == "nu" else ""
                raise InputError(f"relaxation rate s_{field.name} = {value:g}: must lie in (0, 2){mend}")

    @classmethod
    def dhumieres2002(cls, viscosity: float) -> Rates:
        """Rates optimised for linear stability by d'Humieres et al. (2002), p. 445.

        s_e 1.19, s_eps = s_pi 1.4, s_q 1.2, s_m 1.98. The equilibrium stays the second-order one (their
        w_eps = 3, w_epsj = -11/2, w_xx = -1/2).
        """
        return cls(nu=_rate(viscosity, 1 / 3, "viscosity"), e=1.19, eps=1.4, q=1.2, pi=1.4, m=1.98)

    @classmethod
    def two_relaxation_times(cls, viscosity: float, magic: float = 3 / 16) -> Rates:
        """Even moments relax with s_nu, odd ones so that (1/s_nu - 1/2)(1/s_odd - 1/2) = ``magic``.

        3/16 places a half-way bounce-back wall of Poiseuille flow along the grid exactly at half a cell for
        every viscosity (Ginzburg, Verhaeghe & d'Humieres, Commun. Comput. Phys. 3 (2008) 427).
        """
        even = _rate(viscosity, 1 / 3, "viscosity")
        odd = 1.0 / (arguments.positive("magic parameter (3/16 is usual)", magic) / (1 / even - 0.5) + 0.5)
        if odd in (0, 2):
            mend = _COARSER if odd == 2 else _FINER
            raise InputError(f"viscosity = {viscosity:g} with magic parameter {magic:g}: out of range; {mend}")
        return cls(nu=even, e=even, eps=even, q=odd, pi=even, m=odd)

    @classmethod
    def slow_odd(cls, viscosity: float, magic: float = 3 / 16) -> Rates:
        """:meth:`two_relaxation_times` with the even rates of :meth:`dhumieres2002`: for cells beside walls.

        Half-way walls stay where they are, and the even moments, which at low viscosity hardly relax with s_nu,
        are damped: so fast flow at a wall, as when a sphere leaves it, stays stable.
        """
        base = cls.two_relaxation_times(viscosity, magic)
        return replace(base, e=1.19, eps=1.4, pi=1.4)

    @classmethod
    def quiet(cls, viscosity: float) -> Rates:
        """Rates for flow away from walls, stable and quiet where :meth:`two_relaxation_times` are not.

        s_q by the magic parameter 3/16; s_e 1.19 and s_eps = s_pi 1.4 of d'Humieres et al. (2002); s_m 2/3, that
        is L_m = 1/s_m - 1/2 = 1: of little weight between 0.3 and 1.98 (benchmarks/README.md). Beside a wall
        L_m moves the wall; there :class:`lbm.RatesByPlace` has others.
        """
        return replace(cls.slow_odd(viscosity), m=2 / 3)

    @classmethod
    def balanced(cls, viscosity: float, magic: float = 3 / 16) -> Rates:
        """Quiet rates that leave half-way walls where :meth:`two_relaxation_times` put them, everywhere the same.

        Even moments as :meth:`quiet`; L_m = 1/s_m - 1/2 = min(1, magic/L_nu), and L_q such that::

            L_nu (L_q + 3 L_m)/4 = magic

        Notes
        -----
        Of a flow along x between walls normal to z only A = sum c_x c_z^2 f meets the walls. Of the force on a
        cell, F = -grad p - du/dt, A must get all and B = sum c_x c_y^2 f nothing, for no streaming changes B. With
        q_x = 5 (A + B) - 4 j_x, m_x = A - B, and a third of F given to A and to B each, that leaves the
        non-equilibrium parts -5 F/(3 s_q) of q and -F/s_m of m, and of A half of q/5 + m: that of one rate for
        both, L = (L_q + 3 L_m)/4. So a slower q makes up for the fast m that keeps a flow quiet.

        That holds for steady flow: at low viscosity q takes hundreds of steps, and a film of about one cell that a
        sphere closes faster than that is lost. Spheres that meet walls want :meth:`RatesByPlace.balanced`.
        """
        slow = 1 / cls.two_relaxation_times(viscosity, magic).q - 0.5
        fast = min(1.0, slow)
        return replace(cls.quiet(viscosity), q=1 / (4 * slow - 3 * fast + 0.5), m=1 / (fast + 0.5))

    @classmethod
    def bulk(cls, viscosity: float, bulk_viscosity: float, magic: float = 3 / 16) -> Rates:
        """:meth:`two_relaxation_times` with the bulk viscosity chosen separately (d'Humieres et al. 2002)."""
        base = cls.two_relaxation_times(viscosity, magic)
        e = _rate(bulk_viscosity, 2 / 9, "bulk viscosity")
        return cls(nu=base.nu, e=e, eps=base.eps, q=base.q, pi=base.pi, m=base.m)

    @classmethod
    def bgk(cls, viscosity: float) -> Rates:
        """One rate for all (Qian, d'Humieres & Lallemand 1992); for comparison."""
        s = _rate(viscosity, 1 / 3, "viscosity")
        return cls(s, s, s, s, s, s)

    @property
    def viscosity(self) -> float:
        """Kinematic shear viscosity in lattice units."""
        return (1 / self.nu - 0.5) / 3

    @property
    def bulk_viscosity(self) -> float:
        """Kinematic bulk viscosity in lattice units."""
        return (1 / self.e - 0.5) * 2 / 9

    @property
    def grid_reynolds(self) -> float:
        """Largest speed times cell over viscosity up to which flows were shown to be stable.

        Where s_m is 0.3 or more, 53: a Taylor-Green vortex of Re 400 on 48^3 cells starts at 52.4. With slower m
        flows are noisy, or diverge, from about 10 on; with odd rates of 1 and more the wake of a sphere is steady
        at 63 (benchmarks/README.md).
        """
        if self.odd_at_once:
            return 63.0
        return 53.0 if self.m >= _FAST else 10.0

    @property
    def grid_reynolds_at_bodies(self) -> float:
        """The same about a body, by the fastest flow about a sphere held in a stream, up to a noise of 2 %.

        :meth:`balanced`, whose q is slower than two relaxation times have it: Re 250 at 10 cells; it diverged at
        300. :meth:`quiet`: Re 300 at 10 cells; it diverged at 8. Odd rates of 1 and more with even ones about as
        fast, like :meth:`dhumieres2002`: Re 400 at 8 cells.
        """
        if self.odd_at_once:
            return self.grid_reynolds
        return min(31.0 if self._q_is_slow else 37.0, self.grid_reynolds)

    @property
    def grid_reynolds_at_moving_walls(self) -> float:
        """The same at a moving wall, by cubic cavities of Re 1000 that settle.

        :meth:`quiet` and :meth:`dhumieres2002`: 32 cells (31). :meth:`balanced`: 48 (21); at 32 it keeps changing
        by 2 % of the lid's speed. None settles at 24 (42).
        """
        return min(21.0 if self._q_is_slow else 31.0, self.grid_reynolds)

    @property
    def odd_at_once(self) -> bool:
        """Whether q and m relax within a step or two and no even moment overshoots: d'Humieres' rates."""
        return min(self.q, self.m) >= _AT_ONCE and max(self.e, self.eps, self.pi) <= _UNDAMPED

    @property
    def _q_is_slow(self) -> bool:
        return (1 / self.nu - 0.5) * (1 / self.q - 0.5) > _SLOWER

    def layers(self) -> tuple[Rates, ...]:
        """Rates by layer of cells from a wall, of which this is the only one; see :class:`lbm.RatesByPlace`."""
        return (self,)

    def diagonal(self) -> np.ndarray:
        """Rates in the order of :data:`lbm.fluid.moments.NAMES`; conserved moments have rate 0."""
        s = self
        odd = (0.0, s.q)
        return np.array(
            [0.0, s.e, s.eps, *odd, *odd, *odd, s.nu, s.pi, s.nu, s.pi, s.nu, s.nu, s.nu, s.m, s.m, s.m]
        )

    def scaled(self, dtype) -> tuple:
        """Factors of :func:`lbm.fluid.collision.collide`: s/|M|^2 by kind, then (1 - s/2) c/|M|^2 of Guo's force.

        c is the moment of the force per unit of the product of velocity and force that the collision forms.
        """
        kinds = [
            (self.e, 2394, 38), (self.eps, 252, 11), (self.q, 40, 2 / 3), (self.nu, 36, 2), (self.nu, 12, 2),
            (self.nu, 4, 1), (self.pi, 72, 1), (self.pi, 24, 1), (self.m, 8, None),
        ]  # fmt: skip
        relax = [s / norm for s, norm, _ in kinds]
        push = [(1 - s / 2) * c / norm for s, norm, c in kinds if c is not None]
        return tuple(np.dtype(dtype).type(v) for v in (*relax, *push, 1 / 10))


PRESETS = {
    "two-relaxation-times": Rates.two_relaxation_times,
    "dhumieres2002": Rates.dhumieres2002,
    "bgk": Rates.bgk,
    "quiet": Rates.quiet,
    "balanced": Rates.balanced,
}
"""Presets that are the same everywhere and follow from the viscosity alone, by name."""
