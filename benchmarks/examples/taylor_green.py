import numpy as np

from lbm import Rates, Simulation

n, nu, u0 = 64, 0.01, 0.02
k = 2 * np.pi / n
x, y, _ = np.meshgrid(*(k * (np.arange(m) + 0.5) for m in (n, n, 4)), indexing="ij")
u = u0 * np.array([np.cos(x) * np.sin(y), -np.sin(x) * np.cos(y), 0 * x])
rho = 1 - 0.75 * u0**2 * (np.cos(2 * x) + np.cos(2 * y))

flow = Simulation((n, n, 4), Rates.dhumieres2002(viscosity=nu))
flow.set_flow(rho, u)
flow.run(2000, progress=True)

decay = np.sum(flow.velocity**2) / np.sum(u**2)
print(f"viscosity measured / set: {-np.log(decay) / (4 * k**2 * 2000) / nu:.5f}")
