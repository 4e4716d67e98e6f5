r"""How probable the frames of a record are under a solver that is known by an emulator of its runs.

The likelihood of whole trajectories (:mod:`restitution.calibration.trajectories.likelihood`), the model being
the emulated flight. Frame i of a record shows the gap y_i at the time t_i:

    y_i = b + s h(t_i - t_1; w) + u(t_i) + e_i,      w ~ N(<w>(theta), var w(theta)),

theta the parameters of the solver, w the components of the emulator with their own error, b the zero of the
gap, s the scale of the picture, t_1 the time of the first contact. e is the error of a reading and what the
components leave out; u is what the solver lacks at any theta, its discrepancy (Kennedy & O'Hagan, J. R. Stat.
Soc. B 63 (2001) 425), and the drift of the camera: an Ornstein-Uhlenbeck process of the unknown standard
deviation sigma_u and correlation time tau. b, s and w, in which y is linear about its mean, are integrated out;
t_1, sigma_u and tau are unknowns beside theta, with the priors of :mod:`restitution.calibration.trajectories`, but
that sigma_u may be as great as the gaps themselves: a solver may miss a record as a whole.

The e_eff of the bounces do not enter beside the frames: they are made of the same ones and would count twice.
Frames after the last contact that all runs reach have no say, nor have those before the approach of the runs.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from restitution.calibration.estimation.parameters import Flat, Normal, Parameter
from restitution.calibration.trajectories.correlated_noise import products
from restitution.calibration.trajectories.likelihood import noise_prior
from restitution.calibration.trajectories.recordings import Recording
from restitution.emulation.emulator import Emulator
from restitution.emulation.registered import Registration
from restitution.errors import Defect, InputError

LEAST_FRAMES = 6
"""Of a record within the reach of the runs."""
_STEP = 0.05
"""Of a component, in standard deviations of its runs, for the slope of the gaps with it."""


@dataclass(frozen=True)
class FramesLikelihood:
    """One record under one emulator; ``use`` are the frames within the reach of all runs."""

    recording: Recording
    emulator: Emulator
    registration: Registration
    use: NDArray
    touch: Normal
    """Prior of the time of the first contact in s."""

    @classmethod
    def of(cls, r: Recording, emulator: Emulator, registration: Registration, ends_s: float) -> FramesLikelihood:
        """Of the frames from the beginning of the approach of all runs to ``ends_s``, the last contact of all."""
        interval = float(np.median(np.diff(r.time_s)))
        first = r.contacts_s[0]
        at = r.clock.mean if r.clock_of == "contact" or not math.isfinite(first) else first
        after = r.time_s - at
        use = (after > -registration.approach_s) & (after < ends_s - interval)
        if np.count_nonzero(use & (after > 0)) < LEAST_FRAMES:
            rule = (
                f"has {np.count_nonzero(use & (after > 0))} frames between the first and the last contact that "
                f"all runs reach, {1e3 * ends_s:.3g} ms after it: at least {LEAST_FRAMES} are needed. Do the runs "
                "simulate this record, for long enough?"
            )
            raise InputError(Defect(rule, file=r.name))
        return cls(r, emulator, registration, use, Normal(float(at), interval))

    @cached_property
    def furthest(self) -> float:
        """Upper end in m of the prior of sigma_u: the greatest gap of the record or of the mean of the runs."""
        runs = self.registration.d * float(self.registration.shapes(self.emulator.mean).max())
        return max(runs, float(self.recording.gap_m[self.use].max()))

    @property
    def nuisances(self) -> tuple[Parameter, ...]:
        """t_1, sigma_u and tau."""
        (low, high), (short, long) = np.exp(noise_prior(self.recording))
        high = max(high, self.furthest)
        name, t = self.recording.name, self.touch
        reach = (t.mean - 5 * t.sigma, t.mean + 5 * t.sigma)
        return (
            Parameter(f"t_1 of {name}", t.mean, reach, "s", "linear", t, mean=False),
            Parameter(
                f"sigma_u of {name}", math.sqrt(low * high), (low, high), "m", "log", Flat(True), mean=False
            ),
            Parameter(
                f"tau of {name}", math.sqrt(short * long), (short, long), "s", "log", Flat(True), mean=False
            ),
        )

    @cached_property
    def zero(self) -> Normal:
        """What is known of b: the prior, and the frames at rest."""
        r = self.recording
        if not r.rest_frames:
            return Normal(0.0, r.level)
        known, seen = r.level**-2.0, r.rest_frames / r.sigma**2
        return Normal(seen * r.rest_gap / (known + seen), (known + seen) ** -0.5)

    @cached_property
    def reading(self) -> float:
        """Standard deviation in m of a reading and of what the components leave out, of the gaps."""
        left = self.registration.shapes(self.emulator.rest)
        return math.hypot(self.recording.sigma, self.registration.d * float(np.sqrt(np.mean(left**2))))

    def predicted(self, q: NDArray, touch: NDArray, time_s: NDArray | None = None) -> NDArray:
        """Gap in m at recorded times (by default of the frames in use), (B, n), for q (B, .) and t_1 (B,)."""
        t = self.recording.time_s[self.use] if time_s is None else time_s
        return self.registration.gaps(q, t[None, :] - touch[:, None])

    def log(self, theta: NDArray, touch: NDArray, sigma_u: NDArray, tau: NDArray) -> NDArray:
        """ln of the density of the frames, (B,), at parameters (B, p) and the unknowns of the record, (B,)."""
        r, e = self.recording, self.emulator
        y = r.gap_m[self.use]
        n, B, K = len(y), len(theta), len(e.processes)
        mean, variance = e.scores(theta)
        q = e.flight(mean)
        shift = 0.02 * self.touch.sigma
        # Each flight, the same a little earlier, and with each component moved: all at once.
        q_all = np.concatenate([q, q, *(q + _STEP * phi for phi in e.components)])
        touches = np.concatenate([touch, touch - shift, *([touch] * K)])
        h, earlier, *moved = self.predicted(q_all, touches).reshape(K + 2, B, n)
        columns = np.empty((B, n, K + 4))
        columns[:, :, 0] = y - self.zero.mean - h
        columns[:, :, 1] = self.zero.sigma
        columns[:, :, 2] = r.scale * h
        columns[:, :, 3] = r.clock_rate * (earlier - h) / shift * (r.time_s[self.use] - touch[:, None])
        for k in range(K):
            columns[:, :, 4 + k] = (moved[k] - h) / _STEP * np.sqrt(variance[:, k, None])
        gram, log_det = np.empty((B, K + 4, K + 4)), np.empty(B)
        time = np.ascontiguousarray(r.time_s[self.use])
        for i in range(B):
            products(
                time, columns[i], self.reading, sigma_u[i : i + 1], tau[i : i + 1], gram[i : i + 1], log_det[i:]
            )
        root = np.linalg.cholesky(gram[:, 1:, 1:] + np.eye(K + 3))
        half = np.linalg.solve(root, gram[:, 1:, :1])[:, :, 0]
        total = gram[:, 0, 0] - np.sum(half**2, axis=1) + log_det
        total += 2 * np.sum(np.log(np.diagonal(root, axis1=1, axis2=2)), axis=1)
        return -0.5 * (total + n * math.log(2 * math.pi))
