"""Two independent routes to the same ray through stratified air.

Long because both routes share one description of the air's cells and must stay comparable line by line.

(a) `ode`: Dormand-Prince 8(5,3) in arc length with ln P as part of the state; every cell edge and turning point
    is located as the end of a step.
(b) `quad`: Bouguer's invariant and integrals over height, sin^2 b = s0^2 + c0^2 (1 - exp(-2 ln(n r / n0 r0))),
    h = a + (b-a)(3 w^2 - 2 w^3) in each monotone piece (removes the square-root ends), Gauss-Legendre halved
    until it settles.
Both return Ray: angles in radians.
"""
import math
from typing import NamedTuple

import numpy as np
from numba import njit
from scipy.integrate import quad as scipy_quad
from scipy.integrate._ivp import dop853_coefficients as dop

from air import TOP_M, K_HYDROSTATIC, R0_GEOPOTENTIAL, humidity, medium, refractivity_at, temperature

SPACE, GROUND, TRAPPED, FLIGHT, LOST = 0, 1, 2, 3, 4        # LOST: the oracle's own step count ran out
STATUS = ["space", "ground", "trapped", "in-flight", "lost"]
ARCSEC = math.degrees(1.0) * 3600.0
A = np.ascontiguousarray(dop.A[:12, :12])
B = np.ascontiguousarray(dop.B)
E5 = np.ascontiguousarray(dop.E5[:12])
E3 = np.ascontiguousarray(dop.E3[:12])
GX, GW = np.polynomial.legendre.leggauss(16)
GX6, GW6 = np.polynomial.legendre.leggauss(6)


class Ray(NamedTuple):
    status: int
    bending: float       # rad
    h: float             # at the end
    b: float             # elevation at the end, rad
    h_min: float
    h_max: float
    distance: float      # along the surface, m
    turning: int
    optical_path: float  # m
    column: float        # kg/m2


# ---- (a) ODE ------------------------------------------------------------------------------------------------
# y = h, b, ln P, bending, distance, optical path, column

@njit(cache=True)
def rhs(y, c, inv, lay, model, dry, wet, ex, virtual, radius, f):
    N, dN, slope, rho = medium(y[0], y[2], c, inv, lay, model, dry, wet, ex, virtual)
    sb, cb = math.sin(y[1]), math.cos(y[1])
    curve = 0.0 if radius == 0.0 else 1.0 / (radius + y[0])
    g = dN / (1.0 + N)
    f[0] = sb
    f[1] = cb * (curve + g)
    f[2] = slope * sb
    f[3] = -g * cb
    f[4] = cb if radius == 0.0 else cb * radius * curve
    f[5] = 1.0 + N
    f[6] = rho


@njit(cache=True)
def step(y, s, c, inv, lay, model, dry, wet, ex, virtual, radius, k, out):
    tmp = np.empty(7)
    for i in range(12):
        for m in range(7):
            acc = 0.0
            for j in range(i):
                acc += A[i, j] * k[j, m]
            tmp[m] = y[m] + s * acc
        rhs(tmp, c, inv, lay, model, dry, wet, ex, virtual, radius, k[i])
    e5 = e3 = 0.0
    tol = (1e-9, 1e-16, 1e-14, 1e-16, 1e-9, 1e-9, 1e-6)
    for m in range(7):
        acc = a5 = a3 = 0.0
        for i in range(12):
            acc += B[i] * k[i, m]
            a5 += E5[i] * k[i, m]
            a3 += E3[i] * k[i, m]
        out[m] = y[m] + s * acc
        t = tol[m] + 1e-14 * abs(out[m])
        e5 += (s * a5 / t) ** 2
        e3 += (s * a3 / t) ** 2
    den = e5 + 0.01 * e3
    return 0.0 if den == 0.0 else e5 / math.sqrt(den * 7.0)


@njit(cache=True)
def locate(y, s, m, target, c, inv, lay, model, dry, wet, ex, virtual, radius, k, out):
    """Shrinks the step s so that component m ends on target (Illinois false position); returns the step."""
    lo, hi = 0.0, s
    flo, fhi = y[m] - target, out[m] - target
    x = s
    for it in range(80):
        x = (lo * fhi - hi * flo) / (fhi - flo)
        if it > 40 or not (lo < x < hi):
            x = 0.5 * (lo + hi)
        step(y, x, c, inv, lay, model, dry, wet, ex, virtual, radius, k, out)
        fx = out[m] - target
        if fx == 0.0 or hi - lo < 1e-13 * s + 1e-11:
            break
        if (fx > 0) == (fhi > 0):
            hi, fhi = x, fx
            flo *= 0.5
        else:
            lo, flo = x, fx
            fhi *= 0.5
    out[m] = target
    return x


@njit(cache=True)
def start_cell(h, b, edges, cells, inv, lay, model, dry, wet, ex, virtual, radius, ln_p):
    """(cell, direction) of departure; a horizontal ray goes where it curves to."""
    n = cells.shape[0]
    up = min(max(np.searchsorted(edges, h, side="right") - 1, 0), n - 1)
    down = min(max(np.searchsorted(edges, h, side="left") - 1, 0), n - 1)
    if b == 0.0:
        N, dN, _, _ = medium(h, ln_p, cells[up], inv, lay, model, dry, wet, ex, virtual)
        curve = 0.0 if radius == 0.0 else 1.0 / (radius + h)
        if curve + dN / (1 + N) >= 0.0:
            return up, 1
        return down, -1
    return (up, 1) if b > 0 else (down, -1)


@njit(cache=True)
def ode_core(h0, b0, ln_p, stops, top, edges, cells, inv, lay, model, dry, wet, ex, virtual, radius, rows):
    """Marches to the end; rows[i] gets the state at surface distance stops[i].  Returns (status, tps, hmin, hmax)."""
    y = np.zeros(7)
    out = np.zeros(7)
    k = np.zeros((12, 7))
    y[0], y[1], y[2] = h0, b0, ln_p
    ci, sign = start_cell(h0, b0, edges, cells, inv, lay, model, dry, wet, ex, virtual, radius, ln_p)
    hmin = hmax = h0
    upper = lower = nstop = 0
    s = 1.0
    status = -1
    tries = 0
    while status < 0:
        tries += 1
        if tries > 300000 or not math.isfinite(y[0]):
            return LOST, y, upper + lower, hmin, hmax, nstop
        if (h0 <= 0.0 and y[0] <= 0.0 and sign < 0):
            status = GROUND
            break
        c = cells[ci]
        s = min(s, 20000.0)
        err = step(y, s, c, inv, lay, model, dry, wet, ex, virtual, radius, k, out)
        outside = max(c[0] - out[0], out[0] - c[1]) > 0.2 * (c[1] - c[0])
        if err > 1.0 or outside:
            s *= 0.5 if outside else max(0.2, 0.9 * err ** (-0.125))
            if s > 1e-7:
                continue
        grow = min(5.0, 0.9 * max(err, 1e-10) ** (-0.125))
        used, turned = s, False
        if nstop < stops.size and out[4] > stops[nstop]:
            used = locate(y, used, 4, stops[nstop], c, inv, lay, model, dry, wet, ex, virtual, radius, k, out)
        if out[1] * sign < 0.0:
            used = locate(y, used, 1, 0.0, c, inv, lay, model, dry, wet, ex, virtual, radius, k, out)
            turned = True
        crossed = False
        if sign > 0 and out[0] >= c[1]:
            if out[0] > c[1]:
                used = locate(y, used, 0, c[1], c, inv, lay, model, dry, wet, ex, virtual, radius, k, out)
                turned = False
            crossed = True
        elif sign < 0 and out[0] <= c[0]:
            if out[0] < c[0]:
                used = locate(y, used, 0, c[0], c, inv, lay, model, dry, wet, ex, virtual, radius, k, out)
                turned = False
            crossed = True
        if used == s:
            s *= grow
        y[:] = out
        hmin, hmax = min(hmin, y[0]), max(hmax, y[0])
        if nstop < stops.size and y[4] >= stops[nstop]:
            rows[nstop, :7] = y
            rows[nstop, 7] = upper + lower
            nstop += 1
            if nstop == stops.size and stops.size > 0:
                return FLIGHT, y, upper + lower, hmin, hmax, nstop
        if turned:
            y[1] = 0.0
            if sign > 0:
                upper += 1
            else:
                lower += 1
            sign = -sign
            if upper > 0 and lower > 0 and stops.size == 0:
                status = TRAPPED
        elif crossed:
            if sign > 0 and (ci == cells.shape[0] - 1 or y[0] >= top):
                status = SPACE
            elif sign < 0 and ci == 0:
                status = GROUND
            else:
                ci += sign
    return status, y, upper + lower, hmin, hmax, nstop


def ln_pressure_integrated(profile, h):
    """ln P(h) by adaptive quadrature from the ground: independent of the table the other route uses."""
    total = math.log(profile.p0)
    if profile.model == 4:
        return 0.0
    if profile.virtual:
        from air import ln_pressure_table
        return float(ln_pressure_table(h, profile.cells[profile.cell_of(h)]))
    for c in profile.cells:
        if c[0] >= h:
            break
        f = lambda x: -K_HYDROSTATIC * (R0_GEOPOTENTIAL / (R0_GEOPOTENTIAL + x)) ** 2 / temperature(
            complex(x), c, profile.inversions, profile.layers).real
        total += scipy_quad(f, c[0], min(h, c[1]), epsabs=0, epsrel=1e-13)[0]
    return total


_LN_P = {}


def ode(profile, h0, b0, nm, stops=(), flat=False):
    """Ray by the ODE.  With stops: list of (status, h, b, bending, optical path, turning) at surface distances too."""
    key = (profile.serial, h0)
    if key not in _LN_P:
        _LN_P[key] = ln_pressure_integrated(profile, h0)
    stops = np.asarray(stops, float)
    rows = np.zeros((len(stops), 8))
    radius = 0.0 if flat else profile.earth_radius
    status, y, tps, lo, hi, n = ode_core(h0, b0, _LN_P[key], stops, top_of(profile, flat), profile.edges,
                                         *profile.args(nm), radius, rows)
    ray = Ray(status, y[3], y[0], y[1], lo, hi, y[4], tps, y[5], y[6])
    return (ray, rows[:n]) if len(stops) else ray


def top_of(profile, flat):
    return profile.index_levels[-1][0] if flat and profile.model == 4 else TOP_M


# ---- (b) quadrature --------------------------------------------------------------------------------------------

@njit(cache=True)
def ln_nr(h, N, hr, Nr, radius):
    """ln(n r) at h minus that at hr, without cancellation."""
    d = math.log1p((N - Nr) / (1.0 + Nr))
    return d if radius == 0.0 else d + math.log1p((h - hr) / (radius + hr))


@njit(cache=True)
def ln_nr_near(h, delta, hr, N, Nr, c, inv, lay, model, dry, wet, ex, virtual, radius):
    """As ln_nr, but close to hr by integrating the slope, whose relative error stays small as delta = h - hr -> 0."""
    if hr < c[0] or hr > c[1] or abs(delta) > 0.02 * (c[1] - c[0]):
        return ln_nr(h, N, hr, Nr, radius)
    total = 0.0
    for i in range(GX6.size):
        x = hr + 0.5 * delta * (1.0 + GX6[i])
        n1, dn, _ = refractivity_at(x, c, inv, lay, model, dry, wet, ex, virtual)
        total += GW6[i] * (dn / (1.0 + n1) + (0.0 if radius == 0.0 else 1.0 / (radius + x)))
    return 0.5 * delta * total


@njit(cache=True)
def gauss(u0, u1, ha, hb, c, hr, Nr, s2, c2, inv, lay, model, dry, wet, ex, virtual, radius, out):
    out[:] = 0.0
    for i in range(GX.size):
        w = 0.5 * (u0 + u1) + 0.5 * (u1 - u0) * GX[i]
        h = ha + (hb - ha) * w * w * (3.0 - 2.0 * w)
        if ha == hr:                                     # h itself is too coarse a number close to the turning point
            delta = (hb - ha) * w * w * (3.0 - 2.0 * w)
        elif hb == hr:
            delta = (ha - hb) * (1.0 - w) ** 2 * (1.0 + 2.0 * w)
        else:
            delta = h - hr
        jac = 0.5 * (u1 - u0) * GW[i] * abs(hb - ha) * 6.0 * w * (1.0 - w)
        N, dN, rho = refractivity_at(h, c, inv, lay, model, dry, wet, ex, virtual)
        sin2 = s2 - c2 * math.expm1(-2.0 * ln_nr_near(h, delta, hr, N, Nr, c, inv, lay, model, dry, wet, ex, virtual,
                                                           radius))
        if sin2 <= 0.0:
            continue
        sb, cb = math.sqrt(sin2), math.sqrt(max(0.0, 1.0 - sin2))
        ds = jac / sb
        out[0] -= dN / (1.0 + N) * cb * ds
        out[1] += ds * cb if radius == 0.0 else ds * cb * radius / (radius + h)
        out[2] += ds * (1.0 + N)
        out[3] += ds * rho


@njit(cache=True)
def piece(ha, hb, c, hr, Nr, s2, c2, inv, lay, model, dry, wet, ex, virtual, radius, acc):
    """Adds the integrals over ha..hb (inside one cell, no turning point inside) to acc."""
    whole, left, right = np.empty(4), np.empty(4), np.empty(4)
    lo, hi = np.empty(64), np.empty(64)
    lo[0], hi[0] = 0.0, 1.0
    top = 1
    while top > 0:
        top -= 1
        a, b = lo[top], hi[top]
        m = 0.5 * (a + b)
        gauss(a, b, ha, hb, c, hr, Nr, s2, c2, inv, lay, model, dry, wet, ex, virtual, radius, whole)
        gauss(a, m, ha, hb, c, hr, Nr, s2, c2, inv, lay, model, dry, wet, ex, virtual, radius, left)
        gauss(m, b, ha, hb, c, hr, Nr, s2, c2, inv, lay, model, dry, wet, ex, virtual, radius, right)
        ok = True
        for i in range(4):
            v = left[i] + right[i]
            if abs(v - whole[i]) > 2e-13 * abs(v) + 1e-13 * abs(acc[i]) + (1e-16 if i == 0 else 1e-9):
                ok = False
        if ok or b - a < 2e-4 or top > 60:
            acc += left + right
        else:
            lo[top], hi[top] = a, m
            lo[top + 1], hi[top + 1] = m, b
            top += 2


@njit(cache=True)
def quad_core(h0, b0, target, top, lanes, owner, edges, cells, inv, lay, model, dry, wet, ex, virtual, radius):
    """As ode_core, by lanes (cells cut where ln(n r) is stationary).  target > 0: stop at that surface distance."""
    acc = np.zeros(4)
    n = lanes.size - 1
    ci0 = min(max(np.searchsorted(edges, h0, side="right") - 1, 0), cells.shape[0] - 1)
    N0, dN0, _ = refractivity_at(h0, cells[ci0], inv, lay, model, dry, wet, ex, virtual)
    sign = 1 if b0 > 0 else -1
    if b0 == 0.0:
        curve = 0.0 if radius == 0.0 else 1.0 / (radius + h0)
        sign = 1 if curve + dN0 / (1 + N0) >= 0.0 else -1
    lane = np.searchsorted(lanes, h0, side="right") if sign > 0 else np.searchsorted(lanes, h0, side="left")
    lane = min(max(lane - 1, 0), n - 1)
    hr, Nr, s2, c2 = h0, N0, math.sin(b0) ** 2, math.cos(b0) ** 2
    h = hmin = hmax = h0
    upper = lower = 0
    if h0 <= 0.0 and sign < 0:
        return GROUND, acc, h0, s2, sign, 0, hmin, hmax
    trial = np.zeros(4)
    while True:
        c = cells[owner[lane]]
        far = lanes[lane + 1] if sign > 0 else lanes[lane]
        N, _, _ = refractivity_at(far, c, inv, lay, model, dry, wet, ex, virtual)
        f2 = s2 - c2 * math.expm1(-2.0 * ln_nr(far, N, hr, Nr, radius))
        turn = f2 <= 0.0
        end, r_h, r_N, r_s, r_c = far, hr, Nr, s2, c2
        if turn:
            ok, bad = h, far
            for _ in range(200):
                m = 0.5 * (ok + bad)
                if m == ok or m == bad:
                    break
                N, _, _ = refractivity_at(m, c, inv, lay, model, dry, wet, ex, virtual)
                if s2 - c2 * math.expm1(-2.0 * ln_nr(m, N, hr, Nr, radius)) > 0.0:
                    ok = m
                else:
                    bad = m
            end = ok
            N, _, _ = refractivity_at(end, c, inv, lay, model, dry, wet, ex, virtual)
            r_h, r_N, r_s, r_c = end, N, 0.0, 1.0
        trial[:] = 0.0
        piece(h, end, c, r_h, r_N, r_s, r_c, inv, lay, model, dry, wet, ex, virtual, radius, trial)
        if target > 0.0 and acc[1] + trial[1] >= target:
            lo, hi = h, end                           # bisection on the height, then the piece itself
            for _ in range(70):
                m = 0.5 * (lo + hi)
                if m == lo or m == hi:
                    break
                trial[:] = 0.0
                piece(h, m, c, r_h, r_N, r_s, r_c, inv, lay, model, dry, wet, ex, virtual, radius, trial)
                if acc[1] + trial[1] < target:
                    lo = m
                else:
                    hi = m
            trial[:] = 0.0
            piece(h, hi, c, r_h, r_N, r_s, r_c, inv, lay, model, dry, wet, ex, virtual, radius, trial)
            acc += trial
            N, _, _ = refractivity_at(hi, c, inv, lay, model, dry, wet, ex, virtual)
            f2 = r_s - r_c * math.expm1(-2.0 * ln_nr(hi, N, r_h, r_N, radius))
            return FLIGHT, acc, hi, f2, sign, upper + lower, min(hmin, hi), max(hmax, hi)
        acc += trial
        h = end
        hmin, hmax = min(hmin, h), max(hmax, h)
        if turn:
            hr, Nr, s2, c2 = r_h, r_N, 0.0, 1.0
            if sign > 0:
                upper += 1
            else:
                lower += 1
            sign = -sign
            if upper > 0 and lower > 0 and target <= 0.0:
                return TRAPPED, acc, h, 0.0, sign, upper + lower, hmin, hmax
        elif sign > 0 and (lane == n - 1 or far >= top):
            return SPACE, acc, h, f2, sign, upper + lower, hmin, hmax
        elif sign < 0 and lane == 0:
            return GROUND, acc, h, f2, sign, upper + lower, hmin, hmax
        else:
            lane += sign


_LANES = {}


def lanes_of(profile, nm, flat):
    """Cell edges plus the heights where d ln(n r)/dh = 0, and the cell that owns each lane."""
    key = (profile.serial, nm, flat)
    if key in _LANES:
        return _LANES[key]
    args = profile.args(nm)[1:]

    def slope(h, c):
        N, dN, _ = refractivity_at(h, c, *args)
        return dN / (1 + N) + (0.0 if flat else 1.0 / (profile.earth_radius + h))
    lanes, owner = [0.0], []
    for i, c in enumerate(profile.cells):
        x = np.linspace(c[0], c[1], 65)
        v = np.array([slope(t, c) for t in x])
        for a, b, fa, fb in zip(x, x[1:], v, v[1:]):
            if fa * fb < 0:
                for _ in range(90):
                    m = 0.5 * (a + b)
                    if (slope(m, c) > 0) == (fa > 0):
                        a = m
                    else:
                        b = m
                lanes.append(0.5 * (a + b))
                owner.append(i)
        lanes.append(c[1])
        owner.append(i)
    _LANES[key] = (np.array(lanes), np.array(owner))
    return _LANES[key]


def quad(profile, h0, b0, nm, target=0.0, flat=False):
    """Ray by quadrature; target > 0 stops it at that distance along the surface."""
    lanes, owner = lanes_of(profile, nm, flat)
    radius = 0.0 if flat else profile.earth_radius
    status, acc, h, f2, sign, tps, lo, hi = quad_core(h0, b0, target, top_of(profile, flat), lanes, owner,
                                                      profile.edges, *profile.args(nm), radius)
    b = sign * math.asin(math.sqrt(min(1.0, max(0.0, f2))))
    return Ray(status, acc[0], h, b, lo, hi, acc[1], tps, acc[2], acc[3])


def dRda(profile, h0, deg, nm):
    """d(bending)/d(apparent altitude), rad/rad, by fourth-order differences at two steps; None where they disagree."""
    base = quad(profile, h0, math.radians(deg), nm)
    for d in (1e-3, 1e-4, 1e-5, 1e-6):
        got = []
        for e in (d, d / 2):
            r = [quad(profile, h0, math.radians(deg + m * e), nm) for m in (-2, -1, 1, 2)]
            if any((x.status, x.turning) != (base.status, base.turning) for x in r):
                break
            v = [x.bending for x in r]
            got.append((v[0] - 8 * v[1] + 8 * v[2] - v[3]) / (12 * math.radians(e)))
        if len(got) == 2 and abs(got[0] - got[1]) <= 1e-4 * max(abs(got[1]), 1e-3):
            return got[1]
    return None
