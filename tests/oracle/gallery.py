"""What the gallery's pictures must show, worked out from the profiles alone; nothing shared with greenray.

Air: T(h) from the profile file (US76 or straight lines between levels, Fermi steps, exponential surface layers, a
Gaussian over all of it where the file asks for smoothing); ln P and n - 1 as Chebyshev series, panel by panel; n - 1 in proportion
to P/T after Born & Wolf.
Rays: Bouguer's n r cos b = const. A ray that leaves the eye at elevation a has, at height h,
    sin^2 b = sin^2 a + cos^2 a (1 - (n0 r0/(n r))^2),        bending = - integral of (dn/dh)/n cot b dh,
from the eye, or twice from its turning point to the eye and on from there, to 120 km; adaptive Gauss-Legendre (16
points against 2 x 16), with h = h_turn + u^2 beside a turning point. A ray that meets n r = n0 r0 cos a above the eye
comes back: it ends in the sea or is trapped. True altitude t(a) = a - bending.
`check` holds single rays against scipy's DOP853 on the ray equation in arc length.

Run:  python3 tests/oracle/gallery.py          (writes tests/data/gallery/*.csv; a few minutes)
"""
import math
import sys
import tomllib
from pathlib import Path

import numpy as np
from numba import njit
from scipy.integrate import solve_ivp
from scipy.interpolate import PchipInterpolator
from scipy.optimize import brentq, minimize_scalar

ROOT = Path(__file__).resolve().parents[2]
EARTH_M = 6371000.0
R0 = 6356766.0
K = 9.80665 * 28.9644 / 8314.32
TOP_M = 120000.0
ARCSEC = math.degrees(1) * 3600
SUN_RAD = 959.63 / ARCSEC
BASES = np.array([0.0, 11000.0, 20000.0, 32000.0, 47000.0, 51000.0, 71000.0, 84852.0])
LAPSES = np.array([-0.0065, 0.0, 0.001, 0.0028, 0.0, -0.0028, -0.002, 0.0])
BASE_T = np.concatenate([[288.15], 288.15 + np.cumsum(LAPSES[:7] * np.diff(BASES))])
X16, W16 = np.polynomial.legendre.leggauss(16)
XH, WH = np.polynomial.hermite.hermgauss(40)


@njit(cache=True)
def us76(h):
    H = R0 * h / (R0 + h)
    i = 0
    while i < 7 and BASES[i + 1] <= H:
        i += 1
    return BASE_T[i] + LAPSES[i] * (H - BASES[i]), LAPSES[i] * (R0 / (R0 + h)) ** 2


@njit(cache=True)
def plain(h, levels, steps, layers):
    """T and dT/dh before any smoothing."""
    m = levels.shape[0]
    if m == 0:
        t, th = us76(h)
    elif h >= levels[m - 1, 0]:
        t, th = us76(h)
        t += levels[m - 1, 1] - us76(levels[m - 1, 0])[0]
    else:
        i = 0
        while i < m - 2 and h >= levels[i + 1, 0]:
            i += 1
        th = (levels[i + 1, 1] - levels[i, 1]) / (levels[i + 1, 0] - levels[i, 0])
        t = levels[i, 1] + th * (h - levels[i, 0])
    for k in range(steps.shape[0]):
        u = (h - steps[k, 1]) / steps[k, 2]
        f = 1 / (1 + math.exp(u)) if u < 300 else 0.0
        t -= steps[k, 0] * f
        th += steps[k, 0] * f * (1 - f) / steps[k, 2]
    for k in range(layers.shape[0]):
        e = math.exp(-h / layers[k, 1])
        t += layers[k, 0] * e
        th -= layers[k, 0] * e / layers[k, 1]
    return t, th


@njit(cache=True)
def smoothed(h, levels, steps, layers, smooth):
    """Gaussian of standard deviation smooth [m] over T; below the ground T goes on straight."""
    t, th, w = 0.0, 0.0, 0.0
    for i in range(XH.shape[0]):
        x = h + math.sqrt(2.0) * smooth * XH[i]
        if x >= 0:
            a, b = plain(x, levels, steps, layers)
        else:
            a, b = plain(0.0, levels, steps, layers)
            a += b * x
        t += WH[i] * a
        th += WH[i] * b
        w += WH[i]
    return t / w, th / w


@njit(cache=True)
def series(h, mesh, c):
    """Value and slope of the panel's Chebyshev series at h."""
    i = min(max(np.searchsorted(mesh, h, side="right") - 1, 0), mesh.shape[0] - 2)
    u = (2 * h - mesh[i] - mesh[i + 1]) / (mesh[i + 1] - mesh[i])
    v, vh, a, b, da, db = c[i, 0], 0.0, 1.0, u, 0.0, 1.0
    for k in range(1, c.shape[1]):
        v += c[i, k] * b
        vh += c[i, k] * db
        a, b, da, db = b, 2 * u * b - a, db, 2 * b + 2 * u * db - da
    return v, vh * 2 / (mesh[i + 1] - mesh[i])


@njit(cache=True)
def medium(h, factor, mesh, c):
    """ln n, d ln n/dh; n = 1 above the air."""
    if h > TOP_M:
        return 0.0, 0.0
    u, uh = series(h, mesh, c)
    return math.log1p(factor * u), factor * uh / (1 + factor * u)


@njit(cache=True)
def rise(h, h0, ln0, factor, mesh, c):
    """ln(n r) - ln(n0 r0), d ln n/dh."""
    ln, g = medium(h, factor, mesh, c)
    return ln - ln0 + math.log1p((h - h0) / (EARTH_M + h0)), g


@njit(cache=True)
def integrand(u, low, up, inv, h0, ln0, factor, mesh, c):
    """Of the bending over u: h = low + u^2 (up) or low - u^2; inv = ln cos a."""
    h = low + u * u if up else low - u * u
    d, g = rise(h, h0, ln0, factor, mesh, c)
    s2 = -math.expm1(2 * (inv - d))
    if s2 <= 0:
        return 0.0
    return -g * math.sqrt((1 - s2) / s2) * 2 * u


@njit(cache=True)
def panel(a, b, low, up, inv, h0, ln0, factor, mesh, c, tol):
    stack = [(a, b, 0)]
    total = 0.0
    while len(stack) > 0:
        a, b, depth = stack.pop()
        whole, parts = 0.0, 0.0
        half, m = 0.5 * (b - a), 0.5 * (a + b)
        for k in range(16):
            whole += half * W16[k] * integrand(m + half * X16[k], low, up, inv, h0, ln0, factor, mesh, c)
            parts += 0.5 * half * W16[k] * integrand(a + 0.5 * half * (1 + X16[k]), low, up, inv, h0, ln0, factor, mesh, c)
            parts += 0.5 * half * W16[k] * integrand(m + 0.5 * half * (1 + X16[k]), low, up, inv, h0, ln0, factor, mesh, c)
        if abs(whole - parts) < tol or depth > 30:
            total += parts
        else:
            stack.append((a, m, depth + 1))
            stack.append((m, b, depth + 1))
    return total


@njit(cache=True)
def integral(low, high, inv, h0, ln0, factor, mesh, c, tol):
    """Bending between low < high; low may be a turning point."""
    total, at = 0.0, low
    i = np.searchsorted(mesh, low, side="right")
    while at < high:
        end = min(high, mesh[i]) if i < mesh.shape[0] else high
        total += panel(math.sqrt(at - low), math.sqrt(end - low), low, True, inv, h0, ln0, factor, mesh, c, tol)
        at = end
        i += 1
    return total


@njit(cache=True)
def root(a, b, inv, h0, ln0, factor, mesh, c):
    """Height in a..b where ln(n r) - ln(n0 r0) = inv; it is below at a and above at b, or the other way round."""
    fa = rise(a, h0, ln0, factor, mesh, c)[0] - inv
    for _ in range(200):
        m = 0.5 * (a + b)
        f = rise(m, h0, ln0, factor, mesh, c)[0] - inv
        if (f > 0) == (fa > 0):
            a = m
        else:
            b = m
    return 0.5 * (a + b)


@njit(cache=True)
def bend(a, h0, scan, ratio, factor, mesh, c, tol):
    """(status, bending, lowest height). status 0 space, 1 ground, 2 trapped. scan: dense heights that tell turning points."""
    ln0 = medium(h0, factor, mesh, c)[0]
    inv = math.log(math.cos(a))
    start = np.searchsorted(scan, h0)
    # above the eye: does n r come back to the ray's invariant?
    blocked = False
    for i in range(start, scan.shape[0]):
        if scan[i] > h0 and math.log1p(factor * ratio[i]) - ln0 + math.log1p((scan[i] - h0) / (EARTH_M + h0)) < inv:
            blocked = True
            break
        if scan[i] > h0 + 5000 and scan[i] > 5000:
            break
    turn, found = h0, False
    if a < 0 or blocked:
        before = min(h0, TOP_M)
        for i in range(start - 1, -1, -1):
            if scan[i] < h0:
                if math.log1p(factor * ratio[i]) - ln0 + math.log1p((scan[i] - h0) / (EARTH_M + h0)) < inv:
                    turn = root(scan[i], before, inv, h0, ln0, factor, mesh, c)
                    found = True
                    break
                before = scan[i]
        if not found:
            return 1, 0.0, 0.0
        if blocked:
            return 2, 0.0, turn
    total = 0.0
    if found:
        total += 2 * integral(turn, min(h0, TOP_M), inv, h0, ln0, factor, mesh, c, tol)
    if h0 < TOP_M:
        total += integral(h0, TOP_M, inv, h0, ln0, factor, mesh, c, tol)
    return 0, total, turn


class Air:
    """name: of a profile in profiles/."""

    def __init__(self, source):
        path = ROOT / f"profiles/{source}.toml"
        spec = tomllib.loads(path.read_text() if path.exists() else Path(source).read_text())
        self.smooth = float(spec.get("smooth_m", 0.0))
        self.p0 = spec.get("surface_pressure_Pa", 101325.0)
        self.levels = np.array([[r["height_m"], r["temperature_K"]] for r in spec.get("level", [])], float).reshape(-1, 2)
        steps = []
        for r in spec.get("inversion", []):
            if "from_m" in r:
                steps.append([r["rise_K"], 0.5 * (r["from_m"] + r["to_m"]), 0.25 * (r["to_m"] - r["from_m"])])
            else:
                steps.append([r["delta_T_K"], r["height_m"], r["diffuseness_m"]])
        self.steps = np.array(steps, float).reshape(-1, 3)
        self.layers = np.array([[r["delta_T_K"], r["scale_m"]] for r in spec.get("surface_layer", [])], float).reshape(-1, 2)
        edges = {0.0, TOP_M} | {R0 * b / (R0 - b) for b in BASES[1:]} | {h for h, _ in self.levels}
        for _, h, a in self.steps:
            edges |= {h + a * k for k in range(-24, 25, 2)}
        for _, s in self.layers:
            edges |= {s * k for k in (0.5, 1, 2, 3, 5, 8, 12, 18, 25, 35)}
        if self.smooth:
            edges |= {h + self.smooth * k for h, _ in self.levels for k in range(-6, 7)}
        edges |= set(np.geomspace(0.1, 3000, 60)) | set(np.arange(3000, TOP_M, 1000))
        mesh = sorted(e for e in edges if 0 <= e <= TOP_M)
        self.mesh = np.array([m for i, m in enumerate(mesh) if i == 0 or m - mesh[i - 1] > 1e-6])
        self.scan = np.unique(np.concatenate([np.linspace(a, b, 33) for a, b in zip(self.mesh[:-1], self.mesh[1:])]))
        self.curves = {}
        self.tabulate()

    def temperature(self, h):
        if self.smooth and h < 3000:
            return smoothed(h, self.levels, self.steps, self.layers, self.smooth)[0]
        return plain(h, self.levels, self.steps, self.layers)[0]

    def tabulate(self, degree=20):
        """(n-1)/factor as a Chebyshev series in each panel; ln P by integrating the series of g/(R T), from the ground."""
        x = np.cos(np.pi * (np.arange(degree + 1) + 0.5) / (degree + 1))
        rows, ln_p = [], math.log(self.p0)
        for a, b in zip(self.mesh[:-1], self.mesh[1:]):
            h = 0.5 * (a + b) + 0.5 * (b - a) * x
            h_in = np.clip(h, np.nextafter(a, b), np.nextafter(b, a))
            t = np.array([self.temperature(v) for v in h_in])
            fall = np.polynomial.chebyshev.chebint(np.polynomial.chebyshev.chebfit(x, K * (R0 / (R0 + h)) ** 2 / t, degree), lbnd=-1)
            value = ln_p - 0.5 * (b - a) * np.polynomial.chebyshev.chebval(x, fall)
            rows.append(np.polynomial.chebyshev.chebfit(x, np.exp(value) / 101325.0 * 273.15 / t, degree))
            ln_p -= 0.5 * (b - a) * np.polynomial.chebyshev.chebval(1.0, fall)
        self.c = np.array(rows)
        self.ratio = np.array([series(h, self.mesh, self.c)[0] for h in self.scan])

    def parts(self, nm):
        return (28.79e-5 * (1 + 5.67e-3 * (1000 / nm) ** 2), self.mesh, self.c)

    def ray(self, h0, a_deg, nm, tol=1e-10):
        return bend(math.radians(a_deg), h0, self.scan, self.ratio, *self.parts(nm), tol)

    def true_deg(self, h0, a_deg, nm):
        """NaN where light does not come from the sky."""
        status, bending, _ = self.ray(h0, a_deg, nm)
        return a_deg - math.degrees(bending) if status == 0 else math.nan

    # -- bands ---------------------------------------------------------------------------------------------------
    def least_rise(self, h0, nm, low, high):
        """Least ln(n r) - ln(n0 r0) over low..high, refined between the points of the scan."""
        args = (self.parts(nm)[0], self.mesh, self.c)
        ln0 = medium(h0, *args)[0]
        f = lambda h: rise(h, h0, ln0, *args)[0]
        points = np.unique(np.clip(np.concatenate([[low, high], self.scan[(self.scan > low) & (self.scan < high)]]), low, high))
        values = np.array([f(h) for h in points])
        i = int(np.argmin(values))
        a, b = points[max(i - 1, 0)], points[min(i + 1, len(points) - 1)]
        found = minimize_scalar(f, bounds=(a, b), method="bounded", options={"xatol": 1e-9})
        return min(values[i], found.fun)

    def horizon_deg(self, h0, nm):
        """Of the sea: the ray that just misses it."""
        return -math.degrees(math.acos(math.exp(min(0.0, self.least_rise(h0, nm, 0.0, h0)))))

    def strip_deg(self, h0, nm):
        """Half width of the blank strip: rays closer to the horizontal come back from above. 0: there is none."""
        least = self.least_rise(h0, nm, h0, 5000.0) if h0 < 5000 else 0.0
        return math.degrees(math.acos(math.exp(least))) if least < 0 else 0.0

    def bands(self, h0, nm, high_deg):
        low, strip = self.horizon_deg(h0, nm) + 1e-7, self.strip_deg(h0, nm)
        return [(low, -strip - 1e-7), (strip + 1e-7, high_deg)] if strip > 0 else [(low, high_deg)]

    def curve(self, h0, nm, high_deg, step_deg=0.0015):
        """Per band: apparent altitudes and true altitudes."""
        key = (h0, nm, high_deg)
        if key in self.curves:
            return self.curves[key]
        out = self.curves[key] = []
        for low, high in self.bands(h0, nm, high_deg):
            a = np.unique(np.concatenate([np.linspace(low, high, max(3, int((high - low) / step_deg))), low + np.geomspace(1e-6, 1e-3, 10), high - np.geomspace(1e-6, 1e-3, 10)]))
            t = np.array([self.true_deg(h0, x, nm) for x in a])
            out.append((a[~np.isnan(t)], t[~np.isnan(t)]))
        return out

    def folds(self, h0, nm, high_deg, least_deg=1 / 3600):
        found = []
        for a, t in self.curve(h0, nm, high_deg):
            turns = [i for i in range(1, len(t) - 1) if (t[i] - t[i - 1]) * (t[i + 1] - t[i]) < 0]
            for i in turns:
                sign = 1 if t[i] < t[i - 1] else -1
                r = minimize_scalar(lambda x: sign * self.true_deg(h0, x, nm), bounds=(a[i - 1], a[i + 1]), method="bounded", options={"xatol": 1e-9})
                found.append([r.x, sign * r.fun, sign > 0])
        changed = True
        while changed:                      # pairs less than least_deg apart are one wiggle
            changed = False
            for i in range(len(found) - 1):
                if abs(found[i][1] - found[i + 1][1]) < least_deg:
                    del found[i:i + 2]
                    changed = True
                    break
        return found

    def pieces(self, h0, nm, high_deg, centre_deg, radius_deg):
        """Apparent spans in which |t(a) - centre| < radius."""
        spans = []
        for a, t in self.curve(h0, nm, high_deg):
            edges = [a[0], a[-1]]
            for level in (centre_deg - radius_deg, centre_deg + radius_deg):
                for i in range(len(t) - 1):
                    if (t[i] - level) * (t[i + 1] - level) < 0:
                        edges.append(brentq(lambda x: self.true_deg(h0, x, nm) - level, a[i], a[i + 1], xtol=1e-11))
            edges.sort()
            for x, y in zip(edges[:-1], edges[1:]):
                m = self.true_deg(h0, 0.5 * (x + y), nm)
                if abs(m - centre_deg) < radius_deg:
                    if spans and abs(spans[-1][1] - x) < 1e-9:
                        spans[-1][1] = y
                    else:
                        spans.append([x, y])
        return spans

    def widest_arcsec(self, h0, nm, high_deg, centre_deg, radius_deg):
        """Angle at the eye between the limb's points of one row, largest over the rows: refraction keeps azimuths."""
        def half(a):
            t = self.true_deg(h0, a, nm)
            if math.isnan(t):
                return 0.0
            c, t, r = math.radians(centre_deg), math.radians(t), math.radians(radius_deg)
            cos_azimuth = (math.cos(r) - math.sin(t) * math.sin(c)) / (math.cos(t) * math.cos(c))
            return math.acos(cos_azimuth) * math.cos(math.radians(a)) if cos_azimuth < 1 else 0.0
        best = 0.0
        for a, _ in self.curve(h0, nm, high_deg):
            w = [half(x) for x in a]
            i = int(np.argmax(w))
            r = minimize_scalar(lambda x: -half(x), bounds=(a[max(i - 1, 0)], a[min(i + 1, len(a) - 1)]), method="bounded", options={"xatol": 1e-9})
            best = max(best, w[i], -r.fun)
        return 2 * best * ARCSEC

    def lowest_true_deg(self, h0, nm, high_deg):
        values = [self.true_deg(h0, low, nm) for low, _ in self.bands(h0, nm, high_deg)] + [t for _, t, _ in self.folds(h0, nm, high_deg)]
        return min(values)


# ---- air that varies: Novaya Zemlya -------------------------------------------------------------------------------

def check(air, h0, a_deg, nm):
    """The same ray by scipy's DOP853 on the ray equation in arc length: bending [rad]; starts and ends as `ray` does."""
    args = (air.parts(nm)[0], air.mesh, air.c)

    def rhs(_, y):
        g = medium(min(max(y[0], 0.0), TOP_M), *args)[1]
        c = math.cos(y[1])
        return [math.sin(y[1]), c * (1 / (EARTH_M + y[0]) + g), -g * c]

    def space(_, y):
        return y[0] - TOP_M
    space.terminal, space.direction = True, 1
    return solve_ivp(rhs, (0, 1e7), [h0, math.radians(a_deg), 0.0], method="DOP853", rtol=1e-12, atol=[1e-9, 1e-15, 1e-16],
                     events=[space], max_step=500.0).y[2, -1]


@njit(cache=True)
def moving_step(h, jump, centre, width, jump_x, centre_x):
    """Of the Fermi step T - jump f: value, slope by h, slope by x."""
    f = 1 / (1 + math.exp(min((h - centre) / width, 300.0)))
    slope = jump * f * (1 - f) / width
    return -jump * f, slope, -jump_x * f - slope * centre_x


@njit(cache=True)
def varying(h, levels, jump, centre, width, jump_x, centre_x):
    """(P/T)/(P0/273.15) at h: value, slope by h, slope by x."""
    none = np.zeros((0, 3))
    low, ln_p, ln_px = 0.0, 0.0, 0.0
    done = False
    edges = np.array([10.0, 20, 30, 40, 50, 60, 70, 80, 90, 100, 120, 150, 200, 400, 800, 1500, 4000, 9000, 11019.1, 20063.1, 32161.9, 47350.1, 51412.5, 71802.0, 86000.0, 120000.0])
    for e in edges:
        high = min(e, h)
        half = 0.5 * (high - low)
        for k in range(16):
            z = low + half * (1 + X16[k])
            t = plain(z, levels, none, none[:, :2])[0]
            a, _, ax = moving_step(z, jump, centre, width, jump_x, centre_x)
            g = half * W16[k] * K * (R0 / (R0 + z)) ** 2 / (t + a)
            ln_p -= g
            ln_px += g * ax / (t + a)
        low = high
        if high >= h:
            break
    t, th = plain(h, levels, none, none[:, :2])
    a, ah, ax = moving_step(h, jump, centre, width, jump_x, centre_x)
    t, th = t + a, th + ah
    u = math.exp(ln_p) * 273.15 / t
    return u, u * (-K * (R0 / (R0 + h)) ** 2 / t - th / t), u * (ln_px - ax / t)


def novaya_true_deg(a_deg, h0=14.0, nm=550.0):
    """True altitude at the end of a ray through profiles/novaya-zemlya.toml; NaN where it ends on the ice."""
    spec = tomllib.loads((ROOT / "profiles/novaya-zemlya.toml").read_text())
    levels = np.array([[r["height_m"], r["temperature_K"]] for r in spec["level"]], float)
    (step,) = spec["inversion"]
    jump, centre = (PchipInterpolator(step[k]["x_m"], step[k]["value"]) for k in ("delta_T_K", "height_m"))
    ends = [(step[k]["x_m"][0], step[k]["x_m"][-1]) for k in ("delta_T_K", "height_m")]
    factor = 28.79e-5 * (1 + 5.67e-3 * (1000 / nm) ** 2)

    def along(curve, end, x):
        inside = end[0] < x < end[1]
        return float(curve(min(max(x, end[0]), end[1]))), float(curve.derivative()(x)) if inside else 0.0

    def rhs(_, y):
        x = y[1] * EARTH_M
        (j, jx), (c, cx) = along(jump, ends[0], x), along(centre, ends[1], x)
        u, uh, ux = varying(min(max(y[0], 0.0), TOP_M), levels, j, c, float(step["diffuseness_m"]), jx, cx)
        s, q, r = math.sin(y[2]), math.cos(y[2]), EARTH_M + y[0]
        k = factor * (uh * q - ux * s * EARTH_M / r) / (1 + factor * u)
        return [s, q / r, q / r + k, -k]

    def ground(_, y):
        return y[0]

    def space(_, y):
        return y[0] - TOP_M
    ground.terminal, ground.direction = True, -1
    space.terminal, space.direction = True, 1
    s = solve_ivp(rhs, (0, 3e6), [h0, 0.0, math.radians(a_deg), 0.0], method="DOP853", rtol=1e-11, atol=[1e-8, 1e-14, 1e-14, 1e-15],
                  events=[ground, space], max_step=2000.0)
    return a_deg - math.degrees(s.y[3, -1]) if len(s.t_events[1]) else math.nan


# ---- the tables -----------------------------------------------------------------------------------------------------

SCENES = {  # scene: profile, eye [m], true altitude of the Sun's centre where the scene gives it, highest altitude looked at
    "split-sun": ("elevated-duct", 102.0, -0.75, 0.6),
    "double-sun": ("double-sun", 10.0, -0.28, 0.6),
    "omega-sun": ("warm-sea", 6.0, -0.36, 0.6),
    "inferior-mirage-flash": ("warm-sea", 6.0, -0.8728, 0.3),
    "mock-mirage-flash": ("mock-mirage", 60.0, -1.1615, 0.3),
    "sub-duct-flash": ("elevated-duct", 86.0, -1.35, 0.3),
    "young-mock-mirage": ("young-mock-mirage", 54.0, -1.05, 0.5),
    "young-inferior-mirage": ("young-inferior-mirage", 9.28, -0.36, 0.6),
    "sun-from-10km": ("us76", 10000.0, None, -2.0),
    "sun-from-orbit": ("us76", 400000.0, None, -19.0),
    "academic-flash": ("us76", 2.0, None, 0.6),
}


def write(name, header, rows):
    path = ROOT / "tests/data/gallery" / name
    path.write_text("# Made by tests/oracle/gallery.py; see README.md.\n" + header + "\n" + "\n".join(rows) + "\n")
    print(name, len(rows), flush=True)


def main():
    folds, suns, lasts, radius = [], [], [], math.degrees(SUN_RAD)
    for scene, (profile, h0, centre, high) in SCENES.items():
        air = Air(profile)
        for nm in (550.0, 500.0, 650.0):
            folds.append(f"{scene},{profile},{h0:g},{nm:g},horizon,{air.horizon_deg(h0, nm):.9f},")
            strip = air.strip_deg(h0, nm)
            if strip:
                folds.append(f"{scene},{profile},{h0:g},{nm:g},strip,{strip:.9f},")
            if h0 < 100000:
                folds += [f"{scene},{profile},{h0:g},{nm:g},{'lowest' if low else 'highest'},{a:.8f},{t:.8f}" for a, t, low in air.folds(h0, nm, high)]
        if not air.strip_deg(h0, 550.0):
            lasts += [f"{scene},{profile},{h0:g},{nm:g},{air.lowest_true_deg(h0, nm, high):.8f}" for nm in (500.0, 560.0, 650.0)]
        if centre is None and h0 > 5000:    # lower limb 0.014 degree above the sea horizon; from orbit: the centre so far above
            lower = {10000.0: -3.0, 400000.0: -19.68}[h0]
            centre = air.true_deg(h0, lower, 550.0) + (radius if h0 < 100000 else 0)
        if centre is not None:
            spans = air.pieces(h0, 550.0, high, centre, radius)
            words = ";".join(f"{a:.8f} {b:.8f}" for a, b in spans)
            tops = [air.pieces(h0, nm, high, centre, radius) for nm in (520.0, 650.0)]
            rim = f"{(tops[0][-1][1] - tops[1][-1][1]) * 3600:.4f}" if all(tops) else ""
            suns.append(f"{scene},{profile},{h0:g},{centre:.8f},{len(spans)},{words},{(spans[-1][1] - spans[0][0]) * 3600:.4f},"
                        f"{air.widest_arcsec(h0, 550.0, high, centre, radius):.4f},{rim}")
        print(scene, flush=True)
    write("folds.csv", "scene,profile,height_m,wavelength_nm,kind,apparent_deg,true_deg", folds)
    write("suns.csv", "scene,profile,height_m,true_centre_deg,pieces,spans_deg,vertical_arcsec,horizontal_arcsec,rim_arcsec", suns)
    write("last_light.csv", "scene,profile,height_m,wavelength_nm,lowest_true_deg", lasts)
    rows = []
    for a in np.round(np.arange(-0.06, 0.1401, 0.01), 3):
        t, near = novaya_true_deg(a), novaya_true_deg(a + 1e-6)
        if not math.isnan(t):
            rows.append(f"{a:g},{t:.7f},{(near - t) / 1e-6:.4g}")
    write("novaya_zemlya.csv", "apparent_deg,true_deg,slope", rows)
    worst = 0.0
    for profile, h0, a in (("us76", 2.0, 0.0), ("warm-sea", 6.0, -0.05), ("elevated-duct", 86.0, -0.006), ("elevated-duct", 102.0, 0.1),
                           ("young-mock-mirage", 54.0, -0.13), ("mock-mirage", 60.0, -0.12)):
        air = Air(profile)
        _, bending, _ = air.ray(h0, a, 550.0)
        worst = max(worst, abs(check(air, h0, a, 550.0) - bending) * ARCSEC)
    print(f"quadrature against DOP853: {worst:.1e} arcsec")


if __name__ == "__main__":
    main()
