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
    """ln n, d ln n/dh."""
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
        before = h0
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
        total += 2 * integral(turn, h0, inv, h0, ln0, factor, mesh, c, tol)
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
