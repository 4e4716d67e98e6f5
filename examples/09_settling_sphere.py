"""Task: a sphere that settles in a closed tank, with the solver alone.

A nylon sphere of 15 mm is let go 120 mm above the floor of a tank of 100 x 100 x 160 mm filled with silicone oil.
Printed: its greatest speed, beside the measured one and the terminal speed in a wide tank.
Source: A. ten Cate et al., Phys. Fluids 14 (2002) 4012, case E3 (Re 11.6).
"""

from lbm import FlowScales, Rates, Simulation
from lbm.spheres import Sphere, Spheres

DENSITY, VISCOSITY = 962.0, 0.113  # of the oil, kg/m3 and Pa s
DIAMETER, SPHERE_DENSITY = 0.015, 1120.0  # m, kg/m3
TERMINAL, GREATEST = 0.091, 0.0873  # m/s: stated for a wide tank; measured in this one


def main():
    """Greatest speed of the sphere in m/s, and how far it has come by then."""
    flow = FlowScales.from_conditions(
        length_m=DIAMETER, speed_m_s=TERMINAL, viscosity_m2_s=VISCOSITY / DENSITY, density_kg_m3=DENSITY,
        cells=6, lattice_speed=0.05,
    )  # fmt: skip
    lattice, si = flow.scales.lattice, flow.scales.si
    tank = tuple(round(lattice(side, "length")) for side in (0.100, 0.100, 0.160))
    simulation = Simulation(
        tank, Rates.two_relaxation_times(flow.viscosity), faces=dict.fromkeys("xyz", "no-slip"), dtype="float32",
        threads=1,
    )  # fmt: skip
    start = (tank[0] / 2, tank[1] / 2, lattice(0.120 + DIAMETER / 2, "length"))
    gravity = (0, 0, -lattice(9.81, "acceleration"))
    sphere = Spheres([Sphere(flow.length / 2, SPHERE_DENSITY / DENSITY, start)], gravity=gravity)
    simulation.add(sphere)
    simulation.run(round(lattice(0.8, "time")))

    motion = sphere.track()
    greatest = si(-motion["vz"].min(), "velocity")
    fallen = si(start[2] - motion["z"][motion["vz"].argmin()], "length")
    print(
        f"greatest speed {1e3 * greatest:.1f} mm/s after {1e3 * fallen:.0f} mm, measured {1e3 * GREATEST:.1f} mm/s"
    )
    print(f"over the terminal speed of a wide tank: {greatest / TERMINAL:.3f}, measured {GREATEST / TERMINAL:.3f}")
    return {"greatest_speed": greatest, "fallen": fallen}


if __name__ == "__main__":
    main()
