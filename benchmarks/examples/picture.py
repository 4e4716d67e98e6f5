"""The README's picture of the solver: a lid-driven cube, speed and streamlines in its middle plane."""

from pathlib import Path

import matplotlib as mpl
import numpy as np

mpl.use("Agg")
import matplotlib.pyplot as plt

from lbm import NoSlip, Rates, Simulation

n, speed, reynolds = 64, 0.1, 400
lid = {"x": "no-slip", "y": "no-slip", "z-": "no-slip", "z+": NoSlip((speed, 0, 0))}
flow = Simulation((n, n, n), Rates.two_relaxation_times(speed * n / reynolds), faces=lid, dtype="float32")
flow.run(30 * n * 10, progress=True)

u = flow.velocity[:, :, n // 2 - 1 : n // 2 + 1].mean(axis=2) / speed
x = (np.arange(n) + 0.5) / n
figure, axes = plt.subplots(figsize=(4.6, 4.2), layout="constrained")
speeds = axes.pcolormesh(x, x, np.hypot(u[0], u[2]).T, cmap="viridis", vmin=0, vmax=1, shading="gouraud")
axes.streamplot(x, x, u[0].T, u[2].T, color="white", linewidth=0.6, density=1.3, arrowsize=0.7)
axes.set(xlabel="x / L", ylabel="z / L", xlim=(0, 1), ylim=(0, 1), aspect="equal")
axes.set_title(f"Lid-driven cube, Re = {reynolds}, {n}$^3$ cells, middle plane", fontsize=9)
figure.colorbar(speeds, label="speed / lid speed", shrink=0.8)
figure.savefig(Path(__file__).with_name("cavity.png"), dpi=130)
