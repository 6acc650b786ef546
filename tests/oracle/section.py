"""Rays through air that varies along the surface, for tests/data/reference/section: nothing shared with greenray.

Medium: T(h, x) is US76 or straight lines between levels plus Fermi steps whose numbers follow scipy's PCHIP (or straight
lines) in x, constant beyond the ends. P is integrated from the surface over the same x, 16-point Gauss-Legendre per
panel, and d(ln P)/dx is integrated beside it, so that both derivatives of n are exact.
Route 1: in the plane of the path, by arc length s (h, central angle, elevation b, bending):
    dh = sin b, dtheta = cos b/(R+h), db = cos b/(R+h) + k, d(bending) = -k, k = (n_h cos b - n_x sin b R/(R+h))/n
Route 2: Cartesian in space, d(n dr/ds)/ds = grad n: any azimuth, and a check of route 1.
Both by scipy's DOP853. Run:  python3 tests/oracle/section.py  (some minutes; writes the tables)
"""
import math
import tomllib
from pathlib import Path

import numpy as np
from numba import njit
from scipy.integrate import solve_ivp
from scipy.interpolate import PchipInterpolator

ROOT = Path(__file__).resolve().parents[2]
TABLES = ROOT / "tests/data/reference/section"
K_HYDROSTATIC = 9.80665 * 28.9644 / 8314.32
R0 = 6356766.0
TOP_M = 120000.0
EARTH_M = 6371000.0
BASES = np.array([0.0, 11000.0, 20000.0, 32000.0, 47000.0, 51000.0, 71000.0, 84852.0])
LAPSES = np.array([-0.0065, 0.0, 0.001, 0.0028, 0.0, -0.0028, -0.002, 0.0])
BASE_T = np.concatenate([[288.15], 288.15 + np.cumsum(LAPSES[:7] * np.diff(BASES))])
NODES, WEIGHTS = np.polynomial.legendre.leggauss(16)


def refractivity_550(nm):
    return 28.79e-5 * (1 + 5.67e-3 * (1000.0 / nm) ** 2)


@njit(cache=True)
def us76(h):
    H = R0 * h / (R0 + h)
    i = 0
    while i < 7 and BASES[i + 1] <= H:
        i += 1
    return BASE_T[i] + LAPSES[i] * (H - BASES[i]), LAPSES[i] * (R0 / (R0 + h)) ** 2


@njit(cache=True)
def curve(x, knots, c):
    """Piecewise cubic c[:, i] in (x - knots[i]), highest power first; constant outside. Value and slope."""
    if x <= knots[0]:
        return c[3, 0], 0.0
    n = knots.shape[0] - 1
    if x >= knots[n]:
        d = knots[n] - knots[n - 1]
        return ((c[0, n - 1] * d + c[1, n - 1]) * d + c[2, n - 1]) * d + c[3, n - 1], 0.0
    i = 0
    while x >= knots[i + 1]:
        i += 1
    d = x - knots[i]
    return (((c[0, i] * d + c[1, i]) * d + c[2, i]) * d + c[3, i],
            (3 * c[0, i] * d + 2 * c[1, i]) * d + c[2, i])


@njit(cache=True)
def temperature(h, v, levels):
    """T, dT/dh, dT/dx. v: rows (jump, height, width, and their slopes along x)."""
    n = levels.shape[0]
    if n == 0:
        t, th = us76(h)
    elif h >= levels[n - 1, 0]:
        t, th = us76(h)
        t += levels[n - 1, 1] - us76(levels[n - 1, 0])[0]
    else:
        i = 0
        while h >= levels[i + 1, 0]:
            i += 1
        th = (levels[i + 1, 1] - levels[i, 1]) / (levels[i + 1, 0] - levels[i, 0])
        t = levels[i, 1] + th * (h - levels[i, 0])
    tx = 0.0
    for k in range(v.shape[0]):
        u = (h - v[k, 1]) / v[k, 2]
        f = 1 / (1 + math.exp(u)) if u < 300 else 0.0
        slope = f * (1 - f)
        t -= v[k, 0] * f
        th += v[k, 0] * slope / v[k, 2]
        tx -= v[k, 3] * f + v[k, 0] * slope * (v[k, 4] + u * v[k, 5]) / v[k, 2]
    return t, th, tx


@njit(cache=True)
def pressure(h, v, levels, edges):
    """ln P - ln P at the surface, and its slope along x."""
    ln_p, ln_px, low = 0.0, 0.0, 0.0
    for k in range(edges.shape[0]):
        high = min(edges[k], h)
        if high <= low:
            continue
        half = 0.5 * (high - low)
        for i in range(16):
            z = low + half * (1 + NODES[i])
            t, _, tx = temperature(z, v, levels)
            g = K_HYDROSTATIC * (R0 / (R0 + z)) ** 2 / t * half * WEIGHTS[i]
            ln_p -= g
            ln_px += g * tx / t
        low = high
        if low >= h:
            break
    return ln_p, ln_px


@njit(cache=True)
def state(h, v, levels):
    n = v.shape[0]
    edges = np.empty(7 + levels.shape[0] + 27 * n + 81)
    m = 0
    for b in BASES[1:]:
        edges[m] = R0 * b / (R0 - b)
        m += 1
    for k in range(levels.shape[0]):
        edges[m] = levels[k, 0]
        m += 1
    for k in range(n):
        for j in range(27):
            edges[m] = max(0.0, v[k, 1] + (3 * j - 39) * v[k, 2])
            m += 1
    for j in range(81):
        edges[m] = min(TOP_M, 1500.0 * j)
        m += 1
    edges = np.sort(edges)
    h = min(max(h, 0.0), TOP_M)
    t, th, tx = temperature(h, v, levels)
    ln_p, ln_px = pressure(h, v, levels, edges)
    ratio = math.exp(ln_p) * 273.15 / t
    ln_ph = -K_HYDROSTATIC * (R0 / (R0 + h)) ** 2 / t
    rho = math.exp(ln_p) * 101325 * 28.9644 / (8314.32 * t)
    return ratio, ratio * (ln_ph - th / t), ratio * (ln_px - tx / t), rho


class Air:
    def __init__(self, path):
        spec = tomllib.loads(Path(path).read_text())
        linear = spec.get("along_surface", "cubic") == "linear"
        self.levels = np.array([[l["height_m"], l["temperature_K"]] for l in spec.get("level", [])], dtype=float)
        self.levels = self.levels.reshape(-1, 2)
        self.curves = []
        for inversion in spec["inversion"]:
            for key in ("delta_T_K", "height_m", "diffuseness_m"):
                q = inversion[key]
                if not isinstance(q, dict):
                    q = {"x_m": [0.0, 1.0], "value": [q, q]}
                x, y = np.array(q["x_m"], float), np.array(q["value"], float)
                if linear:
                    c = np.zeros((4, len(x) - 1))
                    c[2], c[3] = np.diff(y) / np.diff(x), y[:-1]
                else:
                    c = PchipInterpolator(x, y).c.copy()
                self.curves.append((x, c))
        self.knots = sorted({x for xs, _ in self.curves for x in xs})

    def at(self, x):
        v = np.zeros((len(self.curves) // 3, 6))
        for k in range(v.shape[0]):
            for j in range(3):
                v[k, j], v[k, 3 + j] = curve(x, *self.curves[3 * k + j])
        return v

    def state(self, h, x):
        """rho/rho_ref with its derivatives by h and x, and rho."""
        return state(h, self.at(x), self.levels)


def trace(air, eye_m, altitude_deg, nm, rtol=1e-12, until_m=None):
    """Route 1. Returns a dict of the row."""
    factor = refractivity_550(nm)

    def rhs(_, y):
        h, theta, b = y[0], y[1], y[2]
        u, uh, ux, rho = air.state(h, theta * EARTH_M)
        n = 1 + factor * u
        r = EARTH_M + h
        k = factor * (uh * math.cos(b) - ux * math.sin(b) * EARTH_M / r) / n
        return [math.sin(b), math.cos(b) / r, math.cos(b) / r + k, -k, rho, n]

    def ground(_, y): return y[0]
    def space(_, y): return y[0] - TOP_M
    def turn(_, y): return y[2]
    def there(_, y): return y[1] * EARTH_M - until_m
    ground.terminal, ground.direction = True, -1
    space.terminal, space.direction = True, 1
    events = [ground, space, turn]
    if until_m is not None:
        there.terminal, there.direction = True, 1
        events.append(there)
    start = [eye_m, 0.0, math.radians(altitude_deg), 0.0, 0.0, 0.0]
    s = solve_ivp(rhs, (0, 1e7), start, method="DOP853", rtol=rtol, atol=[1e-9, 1e-15, 1e-15, 1e-16, 1e-6, 1e-6],
                  events=events, max_step=2000.0)
    turns = [t for t in s.t_events[2] if t > 1e-6]
    heights = [eye_m, s.y[0, -1]] + [y[0] for t, y in zip(s.t_events[2], s.y_events[2])]
    status = "ground" if len(s.t_events[0]) else "space" if len(s.t_events[1]) else "in-flight"
    end = s.y[:, -1]
    return dict(status=status, refraction_arcsec=math.degrees(end[3]) * 3600, air=end[4], turning_points=len(turns),
                min_height_m=max(0, min(heights)), max_height_m=max(heights), ground_distance_m=end[1] * EARTH_M,
                height_m=end[0], elevation_deg=math.degrees(end[2]), optical_path_m=end[5])


def trace_in_space(air, eye_m, altitude_deg, nm, azimuth_deg=0.0, rtol=3e-14):
    """Route 2. The path runs along the great circle through the eye (0, 0, R) toward +X; Y is to its right.
    Returns status, refraction in the vertical plane of departure and the turn out of it (clockwise) [arcsec]."""
    factor = refractivity_550(nm)
    a, e = math.radians(azimuth_deg), math.radians(altitude_deg)
    forward = np.array([math.cos(a), math.sin(a), 0.0])
    up = np.array([0.0, 0.0, 1.0])
    side = np.array([-math.sin(a), math.cos(a), 0.0])
    foot = EARTH_M * up   # places are counted from here, so that heights are differences of small numbers

    def height(y):
        d = y[:3]
        return (2 * EARTH_M * d[2] + d @ d) / (EARTH_M + math.sqrt((d + foot) @ (d + foot)))

    def rhs(_, y):
        p, q = y[:3] + foot, y[3:6]
        r = math.sqrt(p @ p)
        u, uh, ux, _ = air.state(height(y), EARTH_M * math.atan2(p[0], p[2]))
        n = 1 + factor * u
        in_plane = p[0] ** 2 + p[2] ** 2
        grad = factor * (uh * p / r + ux * EARTH_M * np.array([p[2], 0.0, -p[0]]) / in_plane)
        return np.concatenate([q / n, grad])

    def ground(_, y): return height(y)
    def space(_, y): return height(y) - TOP_M
    ground.terminal, ground.direction = True, -1
    space.terminal, space.direction = True, 1
    n0 = 1 + factor * air.state(eye_m, 0.0)[0]
    start = np.concatenate([eye_m * up, n0 * (math.cos(e) * forward + math.sin(e) * up)])
    s = solve_ivp(rhs, (0, 1e7), start, method="DOP853", rtol=rtol, atol=[1e-10] * 3 + [1e-16] * 3, events=[ground, space], max_step=2000.0)
    q = s.y[3:6, -1]
    q = q / math.sqrt(q @ q)
    end_e = math.atan2(q @ up, q @ forward)
    status = "ground" if len(s.t_events[0]) else "space" if len(s.t_events[1]) else "in-flight"
    return dict(status=status, refraction_arcsec=math.degrees(e - end_e) * 3600,
                sideways_arcsec=math.degrees(math.asin(q @ side)) * 3600)


def zenith_column(air, eye_m):
    edges = np.unique(np.concatenate([np.linspace(eye_m, eye_m + 500, 101), np.geomspace(eye_m + 500, TOP_M, 200)]))
    total = 0.0
    for low, high in zip(edges[:-1], edges[1:]):
        for x, w in zip(NODES, WEIGHTS):
            total += 0.5 * (high - low) * w * air.state(low + 0.5 * (high - low) * (1 + x), 0.0)[3]
    return total


CASES = {  # profile: (eyes, altitudes)
    "mild": ([2, 60], [-0.5, -0.2, -0.12, -0.1, -0.05, 0, 0.03, 0.07, 0.1, 0.2, 0.5, 2, 10, 45, 89]),
    "duct_ends": ([40, 70], [-0.3, -0.15, -0.1, -0.05, 0, 0.05, 0.1, 0.15, 0.2, 0.4, 1, 5]),
    "thin_moving": ([10, 22, 40], [-0.2, -0.1, -0.05, 0.01, 0.05, 0.1, 0.15, 0.2, 0.5, 3]),
    "hot_patch": ([2, 6], [-0.15, -0.08, -0.05, -0.03, 0, 0.02, 0.05, 0.1, 0.2, 0.5, 2]),
    "novaya-zemlya": ([14], [-0.05, 0, 0.02, 0.05, 0.08, 0.12, 0.2, 0.3, 0.6, 2]),
}


def air_of(name):
    path = TABLES / f"profiles/{name}.toml"
    return Air(path if path.exists() else ROOT / f"profiles/{name}.toml")


def write_refraction():
    rows, worst = [], 0.0
    for name, (eyes, altitudes) in CASES.items():
        air = air_of(name)
        for eye in eyes:
            column = zenith_column(air, eye)
            for altitude in altitudes:
                for nm in (450, 650) if altitude in altitudes[:6] else (550,):
                    r = trace(air, eye, altitude, nm)
                    if r["status"] == "in-flight":
                        continue
                    near = [trace(air, eye, altitude + d, nm, 1e-10) for d in (-1e-6, 1e-6)]
                    same = all(x["status"] == r["status"] for x in near)
                    slope = (near[1]["refraction_arcsec"] - near[0]["refraction_arcsec"]) / 7.2e-3
                    scale = max(1.0, abs(slope))
                    if nm == 550 or altitude == altitudes[1]:
                        s = trace_in_space(air, eye, altitude, nm)
                        assert s["status"] == r["status"], (name, eye, altitude)
                        worst = max(worst, abs(s["refraction_arcsec"] - r["refraction_arcsec"]) / scale)
                    air_mass = f"{r['air'] / column:.9f}"
                    rows.append(f"{name},{eye},{altitude},{nm},{r['status']},{r['refraction_arcsec']:.7f},"
                                f"{air_mass},{r['min_height_m']:.6f},{r['max_height_m']:.6f},"
                                f"{r['ground_distance_m']:.4f},{r['turning_points']},{f'{slope:.5g}' if same else ''}")
        print(name, len(rows), worst, flush=True)
    head = (f"# Made by tests/oracle/section.py: two independent routes agree to {worst:.1e} arcsec (over max(1, |dRda|)).\n"
            "profile,height_m,apparent_altitude_deg,wavelength_nm,status,refraction_arcsec,air_mass,min_height_m,"
            "max_height_m,ground_distance_m,turning_points,dRda\n")
    (TABLES / "refraction.csv").write_text(head + "\n".join(rows) + "\n")


def write_sideways():
    rows = []
    for name, eye, altitudes in (("mild", 60, [-0.1, 0.07, 0.5, 5]), ("hot_patch", 6, [-0.03, 0.2]),
                                 ("novaya-zemlya", 14, [0.02, 0.2])):
        air = air_of(name)
        for azimuth in (0, 2, -10, 45, 90, 135, 180):
            for altitude in altitudes:
                r = trace_in_space(air, eye, altitude, 550, azimuth)
                if r["status"] == "in-flight":   # held by a duct
                    continue
                near = [trace_in_space(air, eye, altitude + d, 550, azimuth, 1e-12) for d in (-1e-6, 1e-6)]
                slope = (near[1]["refraction_arcsec"] - near[0]["refraction_arcsec"]) / 7.2e-3
                rows.append(f"{name},{eye},{altitude},550,{azimuth},{r['status']},{r['refraction_arcsec']:.7f},"
                            f"{r['sideways_arcsec']:.8f},{slope:.5g}")
        print(name, len(rows), flush=True)
    head = ("# Made by tests/oracle/section.py, route 2 (Cartesian, in space). Azimuth clockwise from the direction of x.\n"
            "profile,height_m,apparent_altitude_deg,wavelength_nm,azimuth_deg,status,refraction_arcsec,sideways_arcsec,"
            "dRda\n")
    (TABLES / "azimuths.csv").write_text(head + "\n".join(rows) + "\n")


def write_places():
    rows = []
    for name, eye, altitudes in (("mild", 60, [-0.05, 0.03]), ("duct_ends", 40, [0, 0.1]), ("hot_patch", 2, [0.0, -0.03]),
                                 ("thin_moving", 22, [0.01])):
        air = air_of(name)
        for altitude in altitudes:
            for distance in (5e3, 2.5e4, 1.2e5, 3e5):
                r = trace(air, eye, altitude, 550, until_m=distance)
                if r["status"] != "in-flight":
                    continue
                rows.append(f"{name},{eye},{altitude},550,{distance:.0f},{r['height_m']:.9f},{r['elevation_deg']:.12f},"
                            f"{r['refraction_arcsec']:.7f},{r['optical_path_m']:.6f}")
    head = ("# Made by tests/oracle/section.py, route 1.\n"
            "profile,height_m,apparent_altitude_deg,wavelength_nm,distance_m,end_height_m,elevation_deg,bending_arcsec,"
            "optical_path_m\n")
    (TABLES / "places.csv").write_text(head + "\n".join(rows) + "\n")


if __name__ == "__main__":
    write_places()
    write_refraction()
    write_sideways()
