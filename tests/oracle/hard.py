"""Writes tests/data/reference/hard/*.csv: python hard.py [group ...] (all when none named), groups of hard_profiles.py or `trace`.

Each row by both routes of rays.py (its distance from one another is the row's `oracle_arcsec`); hard_mp.py holds a sample
against a third route in 40 digits.  Directions are put where it hurts: next to every edge (a height of balance or the
ground that the ray just reaches), next to folds (dR/da = 1), on the horizontal, near the zenith, and at random.
"""
import math
import random
import sys

import numpy as np

import hard_profiles
import rays
from air import TOP_M, Profile, refractivity_at
from hard_profiles import HARD, SEED
from rays import ARCSEC, GROUND, SPACE, STATUS, TRAPPED, Ray

HEADER = ("profile,height_m,apparent_altitude_deg,wavelength_nm,status,refraction_arcsec,min_height_m,max_height_m,"
          "ground_distance_m,turning_points,dRda,edge_deg,oracle_arcsec")
NEAR_EDGE = (1e-3, 1e-5, 1.2e-6, 3e-7, 1e-8, 1e-9)       # deg off an edge, both sides
COMMENTS = ["Made by tests/oracle/hard.py, seed {seed}: two independent routes; oracle_arcsec is how far they differ.",
            "edge_deg: distance to the nearest direction at which status or turning points change. dRda: d(refraction)/d(altitude)."]


# ---- rays from any height ----------------------------------------------------------------------------------------

def inside(route, p, h, b, nm):
    """A ray from h; above the air: straight to 120 km and on from there, refracted by no surface at 120 km."""
    if h <= TOP_M:
        return route(p, h, b, nm)
    R, n_top = p.earth_radius, 1 + p.state(TOP_M, nm)[3]
    if b >= 0:
        return Ray(SPACE, 0.0, h, b, h, h, 0.0, 0, 0.0, 0.0)
    grow = math.log1p((h - TOP_M) / (R + TOP_M)) - math.log(n_top)          # ln(cos at 120 km / cos b)
    sin2 = math.sin(b) ** 2 - math.cos(b) ** 2 * math.expm1(2 * grow)
    if sin2 <= 0:
        return Ray(SPACE, 0.0, h, -b, h - 2 * (R + h) * math.sin(b / 2) ** 2, h, -2 * b * R, 1, 0.0, 0.0)
    r = route(p, TOP_M, -math.asin(math.sqrt(sin2)), nm)

    def vacuum(b_air):
        """Central angle between 120 km and h of the straight ray whose elevation in the air at 120 km is b_air."""
        s2 = math.sin(b_air) ** 2 - math.cos(b_air) ** 2 * math.expm1(2 * math.log(n_top))
        out2 = math.sin(b_air) ** 2 - math.cos(b_air) ** 2 * math.expm1(-2 * grow)
        return math.asin(math.sqrt(out2)) - math.asin(math.sqrt(max(0.0, s2)))
    distance = r.distance + R * vacuum(math.asin(math.sqrt(sin2)))
    if r.status == SPACE:
        distance += R * vacuum(r.b)
    return r._replace(distance=distance, h_max=h)


def quad(p, h, deg, nm):
    return inside(rays.quad, p, h, math.radians(deg), nm)


def ode(p, h, deg, nm):
    return inside(rays.ode, p, h, math.radians(deg), nm)


def kind(r):
    return r.status, r.turning


# ---- edges and folds ---------------------------------------------------------------------------------------------

def edges_deg(p, h, nm):
    """Directions, +-, whose rays just reach the ground or a local minimum of n r that nothing hides; and the horizontal."""
    lanes, owner = rays.lanes_of(p, nm, False)
    n_eye = p.state(h, nm)[3] if h <= TOP_M else 0.0
    args = p.args(nm)[1:]
    D = np.array([rays.ln_nr(x, refractivity_at(x, p.cells[owner[min(i, len(owner) - 1)]], *args)[0], h, n_eye, p.earth_radius)
                  for i, x in enumerate(lanes)])
    found = set()
    for side in (lanes < h, lanes > h):
        lowest = 0.0
        order = np.nonzero(side)[0]
        if len(order) and lanes[order[0]] < h:
            order = order[::-1]                                          # from the eye outwards
        for i in order:
            ends = [D[j] for j in (i - 1, i + 1) if 0 <= j < len(D)]
            if D[i] < lowest and (i == 0 or (i < len(D) - 1 and D[i] < min(ends))):
                found.add(math.degrees(math.asin(math.sqrt(-math.expm1(2 * D[i])))))
            lowest = min(lowest, D[i])
    return sorted({0.0} | found | {-a for a in found})


def slope(p, h, deg, nm, gap, base):
    """dR/da [rad/rad]: central differences of fourth order with steps inside the gap to the next edge; one-sided where a kink
    lies within them all."""
    start = min(1e-4, gap / 5)
    steps = [start / 10 ** k for k in range(5) if start / 10 ** k > 1e-12]
    rough = []
    for d in steps:
        got = []
        for e in (d, d / 2):
            r = [quad(p, h, deg + m * e, nm) for m in (-2, -1, 1, 2)]
            if any(kind(x) != kind(base) for x in r):
                break
            v = [x.bending for x in r]
            got.append((v[0] - 8 * v[1] + 8 * v[2] - v[3]) / (12 * math.radians(e)))
            rough.append(max(abs(v[3] - base.bending), abs(v[0] - base.bending)) / math.radians(2 * e))
        if len(got) == 2 and abs(got[0] - got[1]) <= 5e-3 * max(abs(got[1]), 0.1):
            return got[1]
    if rough:
        return max(rough[-4:])
    for m in (1, -1):
        r = quad(p, h, deg + m * steps[-1], nm)
        if kind(r) == kind(base):
            return abs(r.bending - base.bending) / math.radians(steps[-1])
    return None


def folds_deg(p, h, nm, span, edges, rng):
    """Up to two directions where d(true altitude)/da = 0, by bisection on differences."""
    def excess(a):
        d = 2e-6
        r = [quad(p, h, a + m * d, nm) for m in (-1, 1)]
        return None if r[0].status != SPACE or kind(r[0]) != kind(r[1]) else 1 - (r[1].bending - r[0].bending) / math.radians(2 * d)
    grid = sorted(rng.uniform(-span, span) for _ in range(120))
    values = [excess(a) for a in grid]
    found = []
    for a, b, fa, fb in zip(grid, grid[1:], values, values[1:]):
        if fa is None or fb is None or fa * fb >= 0 or any(a <= e <= b for e in edges):
            continue
        for _ in range(30):
            m = 0.5 * (a + b)
            fm = excess(m)
            if fm is None:
                break
            a, b, fa = (m, b, fm) if (fm > 0) == (fa > 0) else (a, m, fa)
        else:
            found.append(0.5 * (a + b))
    return rng.sample(found, min(2, len(found)))


def directions(p, h, nm, rng):
    """Altitudes [deg] to ask, and the edges."""
    edges = edges_deg(p, h, nm)
    dip = max(abs(e) for e in edges) if h > 0 else 0.0
    span = 0.3 + min(dip, 3.0)
    asked = {90.0, 89.9, -90.0, -89.9, 30.0, 3.0, 0.0} | {round(rng.uniform(-span, span), 6) for _ in range(9)}
    if dip > 3:
        asked |= {round(rng.uniform(-dip - 1, -dip + 1), 6) for _ in range(6)}
    picked = rng.sample([e for e in edges if e != 0], min(4, len(edges) - 1))
    picked += [-dip] if dip and -dip not in picked else []
    for e in picked:
        asked |= {e + s * d for d in NEAR_EDGE for s in (-1, 1) if d in rng.sample(NEAR_EDGE, 3)}
    asked |= {s * d for d in (1.2e-6, 1e-8) for s in (-1, 1)}
    for f in folds_deg(p, h, nm, span, edges, rng) if h < TOP_M else []:
        asked |= {round(f, 9), round(f + 1e-6, 9), round(f - 1e-6, 9)}
    return sorted(round(a, 12) for a in asked if -90 <= a <= 90), edges


# ---- rows --------------------------------------------------------------------------------------------------------

STATISTICS = {"worst": 0.0, "dropped": 0}


def row(p, h, deg, nm, edges):
    q, o = quad(p, h, deg, nm), ode(p, h, deg, nm)
    gap = min(abs(deg - e) for e in edges)
    if kind(q) != kind(o):
        print(f"routes differ, row left out: {p.name} {h} {deg} {nm} edge {gap:.1e}: {q} {o}", flush=True)
        STATISTICS["dropped"] += 1
        return None
    if 0 < abs(deg) < 1e-7 and q.status != TRAPPED:       # by heights, double cannot tell the start from the turning point
        level = quad(p, h, 0.0, nm)
        s = slope(p, h, math.copysign(1e-5, deg), nm, 1e-5, quad(p, h, math.copysign(1e-5, deg), nm))
        q = q._replace(bending=level.bending + (s or 0.0) * math.radians(deg), distance=o.distance)
    else:
        s = None if q.status == TRAPPED else slope(p, h, deg, nm, gap if gap > 0 else 1e-4, q)
    if s is None and q.status != TRAPPED:
        s = 1e9
    unsure = abs(q.bending - o.bending) * ARCSEC
    if q.status != TRAPPED and unsure > 2e-6 * max(1.0, abs(s)):
        print(f"routes differ by {unsure:.1e}, slope {s:.1e}, row left out: {p.name} {h} {deg} {nm} edge {gap:.1e}", flush=True)
        STATISTICS["dropped"] += 1
        return None
    where = f"{p.name},{float(h)!r},{float(deg)!r},{nm:g},{STATUS[q.status]}"
    heights = f"{q.h_min:.5f},{q.h_max:.5f}"
    if q.status == TRAPPED:
        return f"{where},,{heights},,{q.turning},,{gap:.2e},"
    STATISTICS["worst"] = max(STATISTICS["worst"], unsure / max(1.0, abs(s)))
    return (f"{where},{q.bending * ARCSEC:.8f},{heights},{q.distance:.3f},{q.turning},{s:.3g},{gap:.2e},{max(unsure, 1e-8):.1e}")


def profile(name):
    return Profile("us76" if name == "us76" else HARD / "profiles" / f"{name}.toml")


def group(name, airs):
    rows = []
    for air, eyes in airs:
        p = profile(air)
        for h in eyes:
            rng = random.Random(f"{SEED} {air} {h}")
            asked, edges = directions(p, h, 550.0, rng)
            for i, a in enumerate(asked):
                rows.append(row(p, h, a, 550.0, edges))
            for a in rng.sample(asked, 3) if h == eyes[0] else []:
                for nm in (400.0, 700.0):
                    rows.append(row(p, h, a, nm, edges_deg(p, h, nm)))
            print(name, air, h, len(asked), flush=True)
    rows = [r for r in rows if r]
    head = "".join(f"# {c.format(seed=SEED)}\n" for c in COMMENTS)
    (HARD / f"{name}.csv").write_text(head + HEADER + "\n" + "".join(r + "\n" for r in rows))
    print(f"{name}: {len(rows)} rows, worst {STATISTICS['worst']:.1e} arcsec over max(1, |dRda|), left out {STATISTICS['dropped']}", flush=True)


def main():
    drawn = hard_profiles.draw()
    for name in sys.argv[1:] or [*drawn, "trace"]:
        STATISTICS.update(worst=0.0, dropped=0)
        if name == "trace":
            import hard_trace
            hard_trace.main(drawn)
        else:
            group(name, drawn[name])


if __name__ == "__main__":
    main()
