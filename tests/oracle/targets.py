"""Writes target_sights.csv: python targets.py. What an upright target at a distance looks like, ray by ray.

For an eye in stratified air, the height above the surface at which the ray of each apparent altitude passes a distance,
by route (a) of rays.py (Dormand-Prince 8(5,3) in arc length, P integrated along); blank where it met the ground before.
"""
import math

from rays import ode
from tables import profile, write

CASES = [  # profile, eye m, distance m, altitudes from, to, step deg: a road; a cold layer that lifts and inverts
    ("hot_road_thin", 1.5, 800.0, -0.36, 0.12, 0.0005),
    ("duct_10K", 15.0, 25000.0, -0.30, 0.45, 0.001),
]
NM = 550.0


def main():
    rows = []
    for name, eye, distance, low, high, step in CASES:
        p = profile(name)
        for i in range(round((high - low) / step) + 1):
            deg = low + i * step
            _, at = ode(p, eye, math.radians(deg), NM, stops=(distance,))
            passed = f"{at[0][0]:.6f},{int(at[0][7])}" if len(at) else ","
            rows.append(f"{name},{eye:g},{NM:g},{distance:g},{deg:.4f},{passed}")
    write("target_sights.csv",
          ["Made by tests/oracle/targets.py (rays.py, ODE): height above the surface at which a ray passes a distance.",
           "height_at_distance_m is blank where the ray met the ground before."],
          "profile,height_m,wavelength_nm,distance_m,apparent_altitude_deg,height_at_distance_m,turning_points", rows)


if __name__ == "__main__":
    main()
