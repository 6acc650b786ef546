"""Folds, trapped strips and numbers of images of an eye, by brute force: python mirages.py [PROFILE..] (all; others' rows stay)

Writes tests/data/mirage/{strips,folds,counts}.csv.  Needs numpy, scipy, numba.  Nothing is shared with greenray: air.py
gives n(h), rays.py bends by Gauss-Legendre quadrature of Bouguer's integrals in double.

strips: the fate of rays is found by bisection in the apparent altitude to 1e-13 rad; the edges of ducts are checked
        against Bouguer's invariant, cos e = N_min/N_eye with the minimum of N = n (R + h)/R by golden section.
folds:  the true altitude a(e) = e - bending is sampled every 1.5", closer towards every edge (geometrically), and on both
        sides of every altitude whose ray turns at a kink of the air; each extreme is closed in on by golden section.
        A pair of folds that differ by less than 0.2" in true altitude is left out, as is a case that has one between 0.02"
        and 0.2".
counts: changes of sign of a(e) - a0 along the samples, for a0 at random (seed 6) but 1" from any fold or end.
        (followed() says where counting ends.)
"""
import math
import random
import sys
from pathlib import Path

import numpy as np
from scipy.optimize import minimize_scalar

import rays
from air import Profile
from rays import ARCSEC

ROOT = Path(__file__).resolve().parent.parent.parent
OUT = ROOT / "tests/data/mirage"
SHIPPED, UNSEEN, REFERENCE = ROOT / "profiles", OUT / "profiles", ROOT / "tests/data/reference/profiles"
LEAST = 0.2 / ARCSEC


def smoothed_mock_mirage():
    """profiles/mock-mirage.toml: 1.6 K from 30 to 50 m, smoothed by a Gaussian of 2 m: by 16-point Gauss-Hermite
    quadrature that is a sum of 16 Fermi steps, exact to rounding (the corners of US76, the lowest at 11 km, stay)."""
    x, w = np.polynomial.hermite_e.hermegauss(16)
    w = w / w.sum()
    return Profile("us76", inversion=[{"delta_T_K": 1.6 * wi, "height_m": 40 - 2 * xi, "diffuseness_m": 5.0}
                                      for xi, wi in zip(x, w)])


CASES = [("us76", 2), ("us76", 1000), ("cold-sea", 10), ("cold-sea", 24), ("cold-sea", 60), ("hot-road", 1.5),
         ("double-sun", 10), ("mock-mirage", 60), ("young-mock", 54), ("young-inferior", 9.28), ("arctic_duct", 20),
         ("arctic_duct", 300), ("duct_10K", 45), ("duct_10K", 90), ("two_inversions", 30), ("thin_fermi", 12),
         ("warm_sea", 8), ("linear_levels", 70), ("cubic_levels", 40), ("inversion_doublesun", 10), ("kinked-duct", 30),
         ("kinked-duct", 80)]
WAVES = {"young-mock": [500, 550, 700], "young-inferior": [500, 550, 700]}


def profile(name):
    if name == "us76":
        return Profile("us76")
    if name == "mock-mirage":
        return smoothed_mock_mirage()
    for folder in (SHIPPED, UNSEEN, REFERENCE):
        if (folder / f"{name}.toml").exists():
            return Profile(folder / f"{name}.toml")
    raise ValueError(name)


class Eye:
    def __init__(self, air, height, nm):
        self.air, self.height, self.nm, self.known = air, height, nm, {}

    def ray(self, e):
        if e not in self.known:
            self.known[e] = rays.quad(self.air, self.height, e, self.nm)
        return self.known[e]

    def fate(self, e):
        return self.ray(e).status

    def true(self, e):
        return e - self.ray(e).bending

    def log_modified(self, h):
        return math.log1p(self.air.state(h, self.nm)[3]) + math.log1p(h / self.air.earth_radius)


def kink_altitudes(eye):
    """Apparent altitudes whose rays turn at an edge of the air's description below 2 km."""
    m0, out = eye.log_modified(eye.height), []
    for h in eye.air.edges[eye.air.edges < 2000]:
        lift = eye.log_modified(h) - m0
        if lift < 0:
            out.append(math.acos(math.exp(lift)))
    return out


def strips(eye, low, high):
    """[(from, to, fate)] by bisection of every change along samples 3" apart and kinks."""
    grid = set(np.arange(low, high, 3 / ARCSEC)) | {high}
    for e in kink_altitudes(eye):
        grid |= {s * e + d for s in (-1, 1) for d in (-1e-7, 1e-7)}
    grid = sorted(e for e in grid if low <= e <= high)
    edges, begin = [], grid[0]
    for a, b in zip(grid, grid[1:]):
        fa, fb = eye.fate(a), eye.fate(b)
        if fa == fb:
            continue
        lo, hi = a, b
        while hi - lo > 1e-13:
            m = 0.5 * (lo + hi)
            if eye.fate(m) == fa:
                lo = m
            else:
                hi = m
        edges.append((begin, lo, fa))
        begin = hi
    edges.append((begin, grid[-1], eye.fate(grid[-1])))
    return edges


def check_duct_edges(eye, found):
    """Every edge of a trapped strip is the level ray of a minimum of N, by golden section on N itself."""
    m0 = eye.log_modified(eye.height)
    tops = []
    heights = np.linspace(0, 1000, 40001)
    m = np.array([eye.log_modified(h) for h in heights])
    for i in range(1, len(m) - 1):
        if m[i] < m[i - 1] and m[i] <= m[i + 1]:
            best = minimize_scalar(eye.log_modified, bracket=(heights[i - 1], heights[i], heights[i + 1]), tol=1e-12)
            tops.append(min(best.fun, m[i]))
    for a, b, fate in found:
        if fate != rays.TRAPPED:
            continue
        for e in (a, b):
            ways = [math.acos(math.exp(t - m0)) for t in tops if t < m0] + [0.0, math.acos(math.exp(min(0.0, m[0] - m0)))]
            assert min(abs(abs(e) - w) for w in ways) < 2e-7, (math.degrees(e), [math.degrees(w) for w in ways])


def samples(eye, a, b):
    grid = set(np.arange(a, b, 1.5 / ARCSEC)) | {a, b}
    for k in range(0, 60):
        d = 1e-7 * 1.25**k
        grid |= {a + d, b - d}
    for e in kink_altitudes(eye):
        grid |= {s * e + d for s in (-1, 1) for d in (-1e-6, -1e-7, -1e-8, 1e-8, 1e-7, 1e-6)}
    return sorted(e for e in grid if a <= e <= b)


def leaps(eye, grid):
    """Cuts a run to space where the rays on the two sides take other ways: the lowest or highest point leaps."""
    runs = [[grid[0]]]
    for a, b in zip(grid, grid[1:]):
        ra, rb = eye.ray(a), eye.ray(b)
        if ra.turning != rb.turning or abs(ra.h_min - rb.h_min) > 0.5 + 2e5 * (b - a) or \
                abs(ra.h_max - rb.h_max) > 0.5 + 2e5 * (b - a):
            lo, hi = a, b
            jump = lambda x, y: abs(eye.ray(x).h_min - eye.ray(y).h_min) + abs(eye.ray(x).h_max - eye.ray(y).h_max)
            while hi - lo > 1e-12:
                m = 0.5 * (lo + hi)
                if jump(lo, m) > jump(m, hi):
                    hi = m
                else:
                    lo = m
            if jump(lo, hi) > 1e-2 or abs(eye.true(hi) - eye.true(lo)) > 1e-6:
                runs[-1].append(lo)
                runs.append([hi])
        runs[-1].append(b)
    return [r for r in runs if len(r) > 2]


def golden(f, a, b):
    g = (math.sqrt(5) - 1) / 2
    c, d = b - g * (b - a), a + g * (b - a)
    fc, fd = f(c), f(d)
    while b - a > 1e-11:
        if fc < fd:
            b, d, fd = d, c, fc
            c = b - g * (b - a)
            fc = f(c)
        else:
            a, c, fc = c, d, fd
            d = a + g * (b - a)
            fd = f(d)
    return (c, fc) if fc < fd else (d, fd)


def folds(eye, grid):
    """[(e, a, is_maximum)] of one run, weak pairs taken out; the weakest difference left and the strongest taken out."""
    v = [eye.true(e) for e in grid]
    turn = [(grid[0], v[0])]
    for i in range(1, len(v) - 1):
        if (v[i] - v[i - 1]) * (v[i + 1] - v[i]) < 0:
            sign = -1 if v[i] > v[i - 1] else 1
            e, f = golden(lambda x: sign * eye.true(x), grid[i - 1], grid[i + 1])
            turn.append((e, sign * f))
    turn.append((grid[-1], v[-1]))
    dropped = 0.0
    while len(turn) > 2:
        d = [abs(turn[k + 1][1] - turn[k][1]) for k in range(len(turn) - 1)]
        k = int(np.argmin(d))
        if d[k] >= LEAST:
            break
        dropped = max(dropped, d[k])
        if k == 0:
            del turn[1]
        elif k == len(turn) - 2:
            del turn[k]
        else:
            del turn[k:k + 2]
    kinds = [turn[k][1] > turn[k - 1][1] for k in range(1, len(turn) - 1)]
    return [(e, a, top) for (e, a), top in zip(turn[1:-1], kinds)], dropped


def followed(eye, runs):
    """Beside the top of a smooth duct the true altitude falls as the logarithm of the distance, and samples end 1e-13 rad from
    it: what is seen lower than 1e-10 rad from such an end is not counted."""
    least = -math.inf
    for run in runs:
        for end, inward in ((run[0], 1), (run[-1], -1)):
            t = [eye.true(end + inward * d) for d in (1e-6, 1e-8, 1e-10)]
            if t[0] - t[1] > 0 and t[1] - t[2] > max(1e-5, 0.5 * (t[0] - t[1])):
                least = max(least, t[2])
    return least


def main():
    tables = {"strips": ["profile,height_m,wavelength_nm,low_deg,high_deg,status"],
              "folds": ["profile,height_m,wavelength_nm,apparent_altitude_deg,true_altitude_deg,kind"],
              "counts": ["profile,height_m,wavelength_nm,true_altitude_deg,images"]}
    wanted_cases = [c for c in CASES if len(sys.argv) < 2 or c[0] in sys.argv[1:]]
    for name, height in wanted_cases:
        air = profile(name)
        for nm in WAVES.get(name, [550]):
            dice = random.Random(6)
            eye, key = Eye(air, height, nm), f"{name},{height},{nm}"
            dip = math.acos(air.earth_radius / (air.earth_radius + height))
            low, high = -dip - math.radians(0.35), math.radians(1.2)
            found = strips(eye, low, high)
            check_duct_edges(eye, found)
            deg = lambda e: f"{math.degrees(e):.9f}"
            tables["strips"] += [f"{key},{deg(a)},{deg(b)},{rays.STATUS[s]}" for a, b, s in found]
            runs, all_folds, ends = [], [], []
            for a, b, s in found:
                if s == rays.SPACE:
                    runs += leaps(eye, samples(eye, a, b))
            for run in runs:
                some, dropped = folds(eye, run)
                assert dropped < 0.1 * LEAST, (key, dropped * ARCSEC)
                all_folds += some
                ends += [eye.true(run[0]), eye.true(run[-1])]
            all_folds.sort()
            tables["folds"] += [f"{key},{deg(e)},{deg(a)},{'maximum' if top else 'minimum'}" for e, a, top in all_folds]
            bounds = [a for _, a, _ in all_folds] + ends
            reach = [a for a in bounds if -0.04 < a < 0.02] or [0.0]
            wanted, lowest, highest = 12, min(reach) - 0.0005, min(max(reach), eye.true(high)) + 0.0005
            deepest = followed(eye, runs)
            while wanted:
                a0 = dice.uniform(lowest, highest)
                if min(abs(a0 - x) for x in bounds) < 1 / ARCSEC:
                    continue
                images = 0
                for run in runs:
                    v = [eye.true(e) - a0 for e in run]
                    images += sum((p < 0) != (q < 0) for p, q in zip(v, v[1:]))
                tables["counts"].append(f"{key},{deg(a0)},{images}")
                wanted -= 1
                if a0 < deepest:
                    tables["counts"].pop()
            print(key, len(found), "strips", len(runs), "runs", len(all_folds), "folds", flush=True)
    notes = [line for line in __doc__.splitlines()[2:] if line.strip()]
    for table, rows in tables.items():
        if len(sys.argv) > 1:
            old = [r for r in (OUT / f"{table}.csv").read_text().splitlines() if r and r[0] != "#"]
            made = {(name, str(height)) for name, height in wanted_cases}
            rows += [r for r in old[1:] if tuple(r.split(",")[:2]) not in made]
        (OUT / f"{table}.csv").write_text("".join(f"# {n}\n" for n in notes) + "\n".join(rows) + "\n")


if __name__ == "__main__":
    main()
