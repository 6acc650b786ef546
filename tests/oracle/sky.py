"""Singly scattered light of a clear sky by brute force: every ray marched through US76 by Runge and Kutta.

Nothing here is shared with greenray.  The eye's bent line of sight is cut into Gauss-Legendre panels; at each place a
fan of rays looks for the Sun's disk, ray by ray, and the disk's light is summed over the directions in which it is
seen, dimmed along each ray.  Writes radiance for a Sun of irradiance 1 outside the air, at three wavelengths whose
coefficients stand below and in tests/sky/single_scattering_test.cpp.

    python3 tests/oracle/sky.py > tests/data/reference/sky_single_scattering.csv
"""
import math

import numpy as np

EARTH = 6371000.0
TOP = 120000.0
SUN_RADIUS = math.radians(959.63 / 3600)
# of 450, 550, 650 nm
RAYLEIGH = np.array([2.126e-5, 9.43e-6, 4.77e-6])       # per kg/m2
OZONE = np.array([1.1e-7, 2.2e-6, 1.66e-6])             # per m at the peak
AEROSOL = np.array([6.5e-5, 5.0e-5, 4.0e-5])            # per m at the surface
GAMMA = 0.0148                                          # depolarisation: rho/(2 - rho)
ALBEDO, ASYMMETRY = 0.97, 0.76
OZONE_PEAK, OZONE_WIDTH, AEROSOL_SCALE = 22000.0, 5000.0, 1200.0
REFRACTIVITY = 2.7797e-4 / 1.225                        # per kg/m3, Born & Wolf at 550 nm in US76

BASES = [0.0, 11000.0, 20000.0, 32000.0, 47000.0, 51000.0, 71000.0, 84852.0]
LAPSES = [-0.0065, 0.0, 0.001, 0.0028, 0.0, -0.0028, -0.002, 0.0]
G_OVER_R = 0.0341631947


def layers():
    T, P, rows = 288.15, 101325.0, []
    for i, (base, lapse) in enumerate(zip(BASES, LAPSES)):
        rows.append((base, T, P, lapse))
        if i + 1 < len(BASES):
            step = BASES[i + 1] - base
            T2 = T + lapse * step
            P *= math.exp(-G_OVER_R * step / T) if lapse == 0 else (T2 / T) ** (-G_OVER_R / lapse)
            T = T2
    return rows


ROWS = layers()


def density(h):
    """kg/m3 at geometric heights h, and its slope."""
    h = np.clip(h, 0.0, None)
    H = 6356766.0 * h / (6356766.0 + h)
    T, P, lapse = np.empty_like(h), np.empty_like(h), np.empty_like(h)
    for base, T0, P0, rate in ROWS:
        on = H >= base
        d = H[on] - base
        T[on] = T0 + rate * d
        P[on] = P0 * (np.exp(-G_OVER_R * d / T0) if rate == 0 else (T[on] / T0) ** (-G_OVER_R / rate))
        lapse[on] = rate
    rho = P / (287.05287 * T)
    slope = -rho * (G_OVER_R + lapse) / T * (6356766.0 / (6356766.0 + h)) ** 2
    out = h > TOP
    rho[out] = slope[out] = 0.0
    return rho, slope


def rates(y):
    """y: height, angle at the centre, elevation, bending, columns of air, ozone, aerosol."""
    rho, slope = density(y[0])
    n, dn = 1 + REFRACTIVITY * rho, REFRACTIVITY * slope
    r = EARTH + y[0]
    c = np.cos(y[2])
    turn = -c * dn / n
    return np.array([np.sin(y[2]), c / r, c / r - turn, turn, rho,
                     np.exp(-0.5 * ((y[0] - OZONE_PEAK) / OZONE_WIDTH) ** 2), np.exp(-y[0] / AEROSOL_SCALE)])


def step(y, ds):
    k1 = rates(y)
    k2 = rates(y + 0.5 * ds * k1)
    k3 = rates(y + 0.5 * ds * k2)
    k4 = rates(y + ds * k3)
    return y + ds / 6 * (k1 + 2 * k2 + 2 * k3 + k4)


def to_space(h, elevations):
    """True altitude and columns of rays from a height; NaN where they meet the ground."""
    y = np.zeros((7, len(elevations)))
    y[0], y[2] = h, elevations
    alive = np.ones(len(elevations), bool)
    hit = np.zeros(len(elevations), bool)
    for _ in range(4000):
        ds = np.where(alive, np.minimum(200.0 + 0.04 * y[0], 1500.0), 0.0)
        y = step(y, ds)
        hit |= y[0] < 0
        alive &= (y[0] < TOP) & ~hit
        if not alive.any():
            break
    true = elevations - y[3]
    true[hit] = np.nan
    return true, y[4:7]


def depth(columns):
    return RAYLEIGH[:, None] * columns[0] + OZONE[:, None] * columns[1] + AEROSOL[:, None] * columns[2]


def disk_density(x):
    """Light of the disk by altitude over its radius, 0.4 + 0.6 mu, integral 1."""
    inside = np.abs(x) < 1
    q = np.sqrt(np.clip(1 - x * x, 0, None))
    return np.where(inside, 0.4 * 2 * q + 0.6 * (math.pi / 2) * (1 - x * x), 0.0) / (0.4 * math.pi + 0.6 * 2 * math.pi / 3)


def sunlight(h, altitude):
    """Share of the Sun's irradiance that reaches a height, per wavelength, and the altitude at which it is seen."""
    high = altitude > math.radians(12)
    if high:
        e = np.array([altitude, altitude + math.radians(0.2)])
        true, columns = to_space(h, e)
        t = (altitude - true[0]) / (true[1] - true[0])
        tau = depth(columns)
        return np.exp(-(tau[:, 0] + t * (tau[:, 1] - tau[:, 0]))), e[0] + t * (e[1] - e[0])
    e = altitude + np.radians(np.arange(-0.4, 2.6, 0.025))
    true, columns = to_space(h, e)
    fine = np.linspace(e[0], e[-1], 20 * len(e))
    ok = ~np.isnan(true)
    if ok.sum() < 2:
        return np.zeros(3), altitude
    fine = fine[(fine >= e[ok][0]) & (fine <= e[ok][-1])]
    # the lowest ray found is up to 0.025 degree above the horizon: look closer there
    if (~ok).any():
        low, high_e = e[~ok][-1], e[ok][0]
        for _ in range(18):
            middle = 0.5 * (low + high_e)
            t1, _ = to_space(h, np.array([middle]))
            if np.isnan(t1[0]):
                low = middle
            else:
                high_e = middle
        extra = high_e + (e[ok][0] - high_e) * np.linspace(0, 1, 6)[:-1] ** 2
        t1, c1 = to_space(h, extra)
        good = ~np.isnan(t1)
        ee = np.concatenate([extra[good], e[ok]])
        tt = np.concatenate([t1[good], true[ok]])
        cc = np.concatenate([c1[:, good], columns[:, ok]], axis=1)
    else:
        ee, tt, cc = e[ok], true[ok], columns[:, ok]
    fine = np.linspace(ee[0], ee[-1], 6000)
    true_f = np.interp(fine, ee, tt)
    tau = depth(np.array([np.interp(fine, ee, c) for c in cc]))
    weight = disk_density((true_f - altitude) / SUN_RADIUS) / SUN_RADIUS * np.cos(fine) / np.cos(true_f)
    de = fine[1] - fine[0]
    share = (np.exp(-tau) * weight).sum(axis=1) * de
    total = weight.sum() * de
    return share, (weight * fine).sum() * de / total if total > 0 else altitude


def rayleigh_phase(c):
    return 3 / (16 * math.pi * (1 + 2 * GAMMA)) * ((1 + 3 * GAMMA) + (1 - GAMMA) * c * c)


def haze_phase(c):
    g = ASYMMETRY
    return (1 - g * g) / (4 * math.pi * (1 + g * g - 2 * g * c) ** 1.5)


def line_of_sight(h, e, panels=12, points=6):
    """Places by path length (Gauss-Legendre in panels that grow), each with its weight [m] and the depth before it."""
    y = np.zeros((7, 1))
    y[0], y[2] = h, e
    length, s = 0.0, y
    while s[0, 0] < TOP:
        s = step(s, 500.0)
        length += 500.0
    x, w = np.polynomial.legendre.leggauss(points)
    edges = length * np.linspace(0, 1, panels + 1) ** 2
    places, at = [], 0.0
    s = y
    for a, b in zip(edges[:-1], edges[1:]):
        for xi, wi in zip(x, w):
            to = 0.5 * (a + b) + 0.5 * (b - a) * xi
            n = max(1, int((to - at) / 400))
            for _ in range(n):
                s = step(s, (to - at) / n)
            at = to
            if s[0, 0] < TOP:
                places.append((s[:, 0].copy(), 0.5 * (b - a) * wi))
    return places


def radiance(sun_deg, e_deg, azimuth_deg, eye_m):
    sun, e, azimuth = map(math.radians, (sun_deg, e_deg, azimuth_deg))
    s = np.array([math.cos(sun) * math.cos(azimuth), math.cos(sun) * math.sin(azimuth), math.sin(sun)])
    total = np.zeros(3)
    for y, weight in line_of_sight(eye_m, e):
        h, turned, local, bent = y[:4]
        up = np.array([math.sin(turned), 0, math.cos(turned)])
        altitude = math.asin(float(np.clip(s @ up, -1, 1)))
        share, seen = sunlight(h, altitude)
        if share.max() <= 0:
            continue
        level = s - (s @ up) * up
        level /= max(np.linalg.norm(level), 1e-12)
        towards = math.cos(seen) * level + math.sin(seen) * up      # the Sun as it is seen from there
        ahead = math.cos(local) * np.array([math.cos(turned), 0, -math.sin(turned)]) + math.sin(local) * up
        c = float(np.clip(towards @ ahead, -1, 1))
        rho = density(np.array([h]))[0][0]
        scatter = RAYLEIGH * rho * rayleigh_phase(c) + ALBEDO * AEROSOL * math.exp(-h / AEROSOL_SCALE) * haze_phase(c)
        total += weight * scatter * share * np.exp(-depth(y[4:7, None])[:, 0])
    return total


CASES = [(60, 90, 0, 2), (30, 90, 0, 2), (30, 20, 90, 2), (30, 2, 60, 2), (10, 45, 180, 2), (10, 5, 0, 2), (3, 30, 120, 2),
         (0, 90, 0, 2), (0, 3, 0, 2), (0, 8, 180, 2), (-3, 90, 0, 2), (-3, 10, 0, 2), (-5, 5, 0, 2), (-6, 20, 90, 2),
         (20, 40, 30, 3000), (-1, 1, 10, 3000)]

if __name__ == "__main__":
    print("# radiance [1/sr] of singly scattered light for a Sun of irradiance 1 outside the air: tests/oracle/sky.py")
    print("sun_altitude_deg,elevation_deg,azimuth_deg,eye_m,radiance_450,radiance_550,radiance_650")
    for case in CASES:
        print(",".join(f"{x:g}" for x in case) + "," + ",".join(f"{x:.6e}" for x in radiance(*case)), flush=True)
