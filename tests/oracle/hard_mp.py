"""A third route for the hard cases, in 36 digits: python hard_mp.py [rows per table].

Shares nothing with the other two but the profile files: T(h) and its slope from the definitions, the hydrostatic integral by
Gauss-Legendre to a Chebyshev series, Bouguer's integrals with h = end +- u^2 at turning points and intervals that shrink by
halves towards both ends of each monotone piece.  Prints, for a sample of rows, how far the committed value is from it.
"""
import csv
import math
import random
import sys
import tomllib

import mpmath
from mpmath import mp, mpf

from hard_profiles import HARD, SEED

mp.dps = 36
ORDER, CHEB = 16, 28


def gauss(order):
    """Nodes and weights on 0..1 by Newton's method on Legendre's polynomial."""
    out = []
    for i in range(order):
        x = mpmath.cos(mp.pi * (i + mpf(3) / 4) / (order + mpf(1) / 2))
        for _ in range(100):
            p0, p1 = mpf(1), x
            for k in range(2, order + 1):
                p0, p1 = p1, ((2 * k - 1) * x * p1 - (k - 1) * p0) / k
            slope = order * (x * p1 - p0) / (x * x - 1)
            dx = p1 / slope
            x -= dx
            if abs(dx) < mpf(10) ** (-mp.dps + 3):
                break
        out.append(((1 + x) / 2, 1 / ((1 - x * x) * slope * slope)))
    return out


NODES = gauss(ORDER)
R0 = mpf(6356766)
K = mpf("9.80665") * mpf("28.9644") / mpf("8314.32")
BASES = [0, 11000, 20000, 32000, 47000, 51000, 71000, 84852]
LAPSES = [mpf(s) for s in ("-0.0065", "0", "0.001", "0.0028", "0", "-0.0028", "-0.002", "0")]
TOP = mpf(120000)


class Air:
    def __init__(self, name, nm):
        spec = {} if name == "us76" else tomllib.loads((HARD / "profiles" / f"{name}.toml").read_text())
        number = lambda rows, *keys: [tuple(mpf(r[k]) for k in keys) for r in rows]
        self.inversions = number(spec.get("inversion", []), "delta_T_K", "height_m", "diffuseness_m")
        self.layers = number(spec.get("surface_layer", []), "delta_T_K", "scale_m")
        self.levels = number(spec.get("level", []), "height_m", "temperature_K")
        if spec.get("interpolation", "linear") != "linear":
            raise ValueError("linear only")
        s = (1000 / mpf(nm)) ** 2
        self.factor = mpf("28.79e-5") * (1 + mpf("5.67e-3") * s) * mpf("273.15") / 101325
        self.radius = mpf(6371000)
        base = [mpf("288.15")]
        for i in range(7):
            base.append(base[i] + LAPSES[i] * (BASES[i + 1] - BASES[i]))
        self.base = base
        self.offset = self.levels[-1][1] - self.us76(self.levels[-1][0])[0] if self.levels else mpf(0)
        self.edges = self.mesh()
        self.series = self.hydrostatic()

    def us76(self, h):
        H = R0 * h / (R0 + h)
        i = max(k for k in range(8) if BASES[k] <= H + mpf("1e-25"))
        return self.base[i] + LAPSES[i] * (H - BASES[i]), LAPSES[i] * (R0 / (R0 + h)) ** 2

    def temperature(self, h, mid):
        """T and dT/dh at h in the smooth piece that holds mid."""
        L = self.levels
        if L and mid < L[-1][0]:
            if mid < L[0][0]:
                T, dT = L[0][1], mpf(0)
            else:
                a, b = next((a, b) for a, b in zip(L, L[1:]) if a[0] <= mid < b[0])
                dT = (b[1] - a[1]) / (b[0] - a[0])
                T = a[1] + dT * (h - a[0])
        else:
            H = R0 * mid / (R0 + mid)
            i = max(k for k in range(8) if BASES[k] <= H)
            T = self.base[i] + LAPSES[i] * (R0 * h / (R0 + h) - BASES[i]) + self.offset
            dT = LAPSES[i] * (R0 / (R0 + h)) ** 2
        for d, c, a in self.inversions:
            e = mpmath.exp((h - c) / a)
            T += -d + d * e / (1 + e)
            dT += d / a * e / (1 + e) ** 2
        for d, s in self.layers:
            e = d * mpmath.exp(-h / s)
            T += e
            dT -= e / s
        return T, dT

    def mesh(self):
        e = {mpf(0), TOP} | {h for h, _ in self.levels}
        last = self.levels[-1][0] if self.levels else -1
        e |= {R0 * H / (R0 - H) for H in BASES[1:] if R0 * H / (R0 - H) > last}
        for _, c, a in self.inversions:
            e |= {c + s * a * mpf(m) for s in (-1, 1) for m in (0, 1, 2, 3, 4, "5.5", 7, 9, 12, 16, 22, 30, 42, 60, 90, 150, 300)}
        for _, s in self.layers:
            e |= {s * mpf(m) for m in (1, 2, 3, 4, "5.5", 7, 9, 12, 16, 22, 30, 42, 60, 90, 150, 300)}
        e |= {mpf(m) for m in (1, 10, 50, 150, 400, 800)} | {mpf(k) * 1000 for k in range(1, 120)}
        out = []
        for h in sorted(x for x in e if 0 <= x <= TOP):
            if not out or h - out[-1] > mpf("1e-12"):
                out.append(h)
        return out

    def hydrostatic(self):
        """Per cell: ln P at its bottom and the Chebyshev coefficients of the rest."""
        ln_p, out = mpmath.log(101325), []
        u = [mpmath.cos(mp.pi * (k + mpf(1) / 2) / CHEB) for k in range(CHEB)]
        cos = [[mpmath.cos(mp.pi * j * (k + mpf(1) / 2) / CHEB) for k in range(CHEB)] for j in range(CHEB)]
        for a, b in zip(self.edges, self.edges[1:]):
            f = []
            for x in u:
                h = (a + b) / 2 + (b - a) / 2 * x
                f.append(-K * (R0 / (R0 + h)) ** 2 / self.temperature(h, (a + b) / 2)[0])
            c = [2 * mpmath.fsum(f[k] * cos[j][k] for k in range(CHEB)) / CHEB for j in range(CHEB)] + [mpf(0)] * 2
            c[0] /= 2
            s = [mpf(0)] + [((2 if j == 1 else 1) * c[j - 1] - c[j + 1]) / (2 * j) for j in range(1, CHEB + 1)]
            s = [x * (b - a) / 2 for x in s]
            s[0] = -mpmath.fsum(s[j] * (-1) ** j for j in range(1, len(s)))
            out.append((ln_p, s))
            ln_p += mpmath.fsum(s)
        return out

    def at(self, h, i):
        """n-1, dn/dh and ln(n r / R) at h in cell i."""
        a, b = self.edges[i], self.edges[i + 1]
        u = (2 * h - a - b) / (b - a)
        ln_p, s = self.series[i]
        b1 = b2 = mpf(0)
        for k in range(len(s) - 1, 0, -1):
            b1, b2 = s[k] + 2 * u * b1 - b2, b1
        P = mpmath.exp(ln_p + s[0] + u * b1 - b2)
        T, dT = self.temperature(h, (a + b) / 2)
        N = self.factor * P / T
        return N, N * (-K * (R0 / (R0 + h)) ** 2 / T - dT / T), mpmath.log1p(N) + mpmath.log1p(h / self.radius)

    def slope(self, h, i):
        N, dN, _ = self.at(h, i)
        return dN / (1 + N) + 1 / (self.radius + h)


def pieces(air):
    """(low, high, cell): cells cut where ln(n r) is stationary."""
    out = []
    for i, (a, b) in enumerate(zip(air.edges, air.edges[1:])):
        n = 12 if b < 3000 else 1
        x = [a + (b - a) * k / n for k in range(n + 1)]
        v = [air.slope(t, i) for t in x]
        low = a
        for p, q, fp, fq in zip(x, x[1:], v, v[1:]):
            if fp * fq < 0:
                root = mpmath.findroot(lambda t: air.slope(t, i), (p, q), solver="anderson", tol=mpf(10) ** -50, verify=False)
                out.append((low, root, i))
                low = root
        out.append((low, b, i))
    return out


def integrate(air, i, h_from, h_to, sin2, turn):
    """Bending between two heights of one piece; turn: h_to is a turning point."""
    def f(h):
        N, dN, M = air.at(h, i)
        s2 = sin2(M)
        return mpf(0) if s2 <= 0 else -dN / (1 + N) * mpmath.sqrt((1 - s2) / s2)
    length = abs(h_to - h_from)
    sign = 1 if h_to > h_from else -1
    ends = [max(mpf(0), sin2(air.at(h, i)[2])) for h in (h_from, h_to)]
    deepest = 90 if not turn and min(ends) < max(ends) / 10 ** 10 else 30
    steps = [mpf(2) ** -k for k in range(deepest, 0, -1)]
    cuts = [mpf(0)] + steps + [1 - s for s in steps[::-1]][1:] + [mpf(1)]
    if not turn:
        if min(ends) > max(ends) / 4:
            cuts = [mpf(0), mpf(1) / 2, mpf(1)]
        elif min(ends) > max(ends) / 10 ** 6:
            cuts = [mpf(0)] + steps[-14:] + [1 - s for s in steps[-14:][::-1]][1:] + [mpf(1)]
    total = mpf(0)
    for a, b in zip(cuts, cuts[1:]):
        for x, w in NODES:
            u = a + (b - a) * x
            if turn:                                       # h = h_to -+ length u^2
                total += (b - a) * w * length * 2 * u * f(h_to - sign * length * u * u)
            else:
                total += (b - a) * w * length * f(h_from + sign * length * u)
    return total


def bending(air, cut, eye, deg):
    """(status, bending [arcsec], turning points)."""
    eye, e = mpf(eye), mpf(deg) * mp.pi / 180
    s0, c0 = mpmath.sin(e) ** 2, mpmath.cos(e) ** 2
    here = next(k for k, (a, b, _) in enumerate(cut) if a <= eye <= b and (eye < b or b == TOP))
    M0 = air.at(eye, cut[here][2])[2]
    sin2 = lambda M: s0 - c0 * mpmath.expm1(-2 * (M - M0))
    up = e > 0 or (e == 0 and air.slope(eye, cut[here][2]) >= 0)
    if eye == 0 and not up:
        return "ground", mpf(0), 0
    if not up and eye == cut[here][0]:
        here -= 1
    h, total, turned, lower, upper = eye, mpf(0), 0, 0, 0
    while True:
        a, b, i = cut[here]
        end = b if up else a
        if sin2(air.at(end, i)[2]) <= 0:
            good, bad = h, end
            for _ in range(140):
                m = (good + bad) / 2
                good, bad = (m, bad) if sin2(air.at(m, i)[2]) > 0 else (good, m)
            total += integrate(air, i, h, good, sin2, True)
            h, lower, upper = good, lower + (not up), upper + up
            up = not up
            if lower and upper:
                return "trapped", None, lower + upper
            # back over the same piece to its other end, from the turning point
            a2 = a if not up else b
            total += integrate(air, i, a2, h, sin2, True)
            h = a2
        else:
            was_turn = abs(sin2(air.at(h, i)[2])) < mpf(10) ** -30
            total += integrate(air, i, h, end, sin2, False) if not was_turn else integrate(air, i, end, h, sin2, True)
            h = end
        if up and h >= TOP:
            return "space", total * 180 * 3600 / mp.pi, lower + upper
        if not up and h <= 0:
            return "ground", total * 180 * 3600 / mp.pi, lower + upper
        here += 1 if up else -1


def main():
    count = int(sys.argv[1]) if len(sys.argv) > 1 else 12
    for table in ("thin_inversions", "surface_layers", "ducts", "stacked", "levels", "horizon"):
        path = HARD / f"{table}.csv"
        rows = [r for r in csv.DictReader(l for l in path.read_text().splitlines() if l[0] != "#") if r["profile"] != "duct_cubic"]
        rng = random.Random(f"{SEED} {table}")
        numbers = [r for r in rows if r["refraction_arcsec"]]
        sample = rng.sample(numbers, count - count // 3) + rng.sample([r for r in numbers if float(r["edge_deg"]) < 2e-6], count // 3)
        worst = beyond = 0.0
        for r in sample:
            air = Air(r["profile"], r["wavelength_nm"])
            status, R, turning = bending(air, pieces(air), float(r["height_m"]), float(r["apparent_altitude_deg"]))
            if (status, turning) != (r["status"], int(r["turning_points"])):
                print("differs:", r, status, turning, flush=True)
                continue
            gap, scale = abs(float(R - mpf(r["refraction_arcsec"]))), max(1.0, abs(float(r["dRda"])))
            worst, beyond = max(worst, gap / scale), max(beyond, gap / float(r["oracle_arcsec"]))
            print(f"  {r['profile']} {r['height_m']} {r['apparent_altitude_deg']} {r['status']}: {gap:.1e}, over dR/da {gap / scale:.1e}, "
                  f"oracle_arcsec {r['oracle_arcsec']}, edge {r['edge_deg']}", flush=True)
        print(f"{table}: {len(sample)} rows, {worst:.1e} arcsec over max(1, |dRda|), {beyond:.2g} times oracle_arcsec", flush=True)


if __name__ == "__main__":
    main()
