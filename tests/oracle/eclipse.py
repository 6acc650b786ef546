"""Light in the Earth's shadow at the Moon by brute force: backward from a point of the shadow, ray by ray.

Nothing here is shared with greenray.  Rays that graze the limb of US76 are marched by Runge and Kutta (sky.py); radiance
is the same along a ray but for what the air takes, so the irradiance at a point of the shadow is the Sun's radiance,
dimmed, integrated over the directions in which, after bending, the Sun's disk (0.4 + 0.6 mu) is met.  greenray spreads
the flux of rings instead.  Writes irradiance over that outside the shadow, at the three wavelengths of sky.py, no haze.

    python3 tests/oracle/eclipse.py > tests/data/reference/earth_shadow.csv
"""
import math

import numpy as np
from scipy.interpolate import CubicSpline

import sky

MOON, SUN = 384.4e6, 149.6e9


def graze(h):
    """Impact parameter, whole bending and columns of rays whose lowest points lie at heights h."""
    y = np.zeros((7, len(h)))
    y[0] = h
    while (y[0] < sky.TOP).any():
        y = sky.step(y, np.where(y[0] < sky.TOP, 250.0 + 0.01 * y[0], 0.0))
    impact = (1 + sky.REFRACTIVITY * sky.density(h)[0]) * (sky.EARTH + h)
    return impact, 2 * y[3], 2 * y[4:6]


def limb():
    h = np.concatenate([np.arange(0, 40e3, 100.0), np.arange(40e3, 100e3, 1000.0)])
    impact, bending, columns = graze(h)
    b = np.linspace(impact[0], impact[-1], 30000)
    b = 0.5 * (b[1:] + b[:-1])
    tau = sum(k[:, None] * CubicSpline(impact, c)(b) for k, c in zip((sky.RAYLEIGH, sky.OZONE), columns))
    return b, np.full_like(b, b[1] - b[0]), CubicSpline(impact, bending)(b), np.exp(-tau)


def beyond(b):
    """Rings above the air, whose light goes straight."""
    edges = np.linspace(b[-1], b[-1] + 8000e3, 4000)
    return 0.5 * (edges[1:] + edges[:-1]), np.diff(edges)


def share(x, air):
    b, db, bending, passed = air
    above, dabove = beyond(b)
    b, db = np.concatenate([b, above]), np.concatenate([db, dabove])
    bending = np.concatenate([bending, np.zeros_like(above)])
    passed = np.concatenate([passed, np.ones((3, len(above)))], axis=1)
    axis = b * (1 / SUN + 1 / MOON) - bending        # of the ray's far end from the Sun's centre, at x = 0 [rad]
    total = np.zeros(3)
    steps = 2000
    disk = sky.SUN_RADIUS
    for i in np.nonzero(np.abs(np.abs(axis) - x / MOON) < disk)[0]:
        r, d = axis[i], x / MOON
        widest = math.pi
        if r * d != 0:
            c = (r * r + d * d - disk * disk) / (2 * abs(r) * d)
            widest = math.acos(max(-1.0, min(1.0, c)))
        phi = (np.arange(steps) + 0.5) * widest / steps  # about the side on which the disk is met
        t2 = (r * r - 2 * abs(r) * d * np.cos(phi) + d * d) / disk**2
        light = np.where(t2 < 1, 0.4 + 0.6 * np.sqrt(np.clip(1 - t2, 0, None)), 0).mean() * 2 * widest
        total += passed[:, i] * light * b[i] * db[i] / MOON**2
    seen = disk * SUN / (SUN + MOON)
    return total / (0.8 * math.pi * seen**2)


if __name__ == "__main__":
    air = limb()
    print("# irradiance in the Earth's shadow over that outside it, by the distance from its axis: tests/oracle/eclipse.py")
    print("from_axis_km,share_450,share_550,share_650")
    for km in (0, 500, 1000, 1500, 2000, 2500, 3000, 3500, 4000, 4300, 4600, 5000, 6371, 7500, 8400):
        print(f"{km}," + ",".join(f"{v:.5e}" for v in share(km * 1e3, air)), flush=True)
