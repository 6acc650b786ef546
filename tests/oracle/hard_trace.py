"""Rays followed along the surface through the hard airs, 1 to 1000 km: tests/data/reference/hard/trace.csv.

By the ODE, kept where the quadrature stopped at the same distance agrees to 1e-5 m and 2e-5 arcsec over `amplification`:
|dh/da| / distance, how much more the height moves with the direction than it would in straight flight, 1 at least.
"""
import math
import random

import rays
from hard_profiles import HARD, SEED
from rays import ARCSEC, STATUS

STOPS = [1e3, 1e4, 5e4, 2e5, 1e6]
HEADER = ("profile,height_m,apparent_altitude_deg,wavelength_nm,surface,distance_m,status,end_height_m,elevation_deg,"
          "bending_arcsec,optical_path_m,amplification")


def followed(p, h, deg, flat):
    return rays.ode(p, h, math.radians(deg), 550.0, STOPS, flat)


def amplification(p, h, deg, flat, i, x):
    """None where a kink or an end makes two steps disagree."""
    got = []
    for d in (2e-7, 1e-7):
        ends = [followed(p, h, deg + s * d, flat)[1] for s in (-1, 1)]
        if min(len(e) for e in ends) <= i or ends[0][i][7] != ends[1][i][7]:
            return None
        got.append(abs(ends[1][i][0] - ends[0][i][0]) / math.radians(2 * d) / x)
    return max(1.0, *got) if abs(got[0] - got[1]) < 0.2 * max(1.0, got[1]) else None


def rows_of(p, h, deg, flat):
    end, passed = followed(p, h, deg, flat)
    out, worst = [], 0.0
    for i, x in enumerate(STOPS):
        scale = amplification(p, h, deg, flat, i, x)
        if i < len(passed):
            y = passed[i]
            q = rays.quad(p, h, math.radians(deg), 550.0, x, flat)
            gap = max(abs(q.h - y[0]), abs(q.bending - y[3]) * ARCSEC * 0.5)
            if scale is None or q.status != rays.FLIGHT or gap > 1e-5 * scale:
                print(f"left out: {p.name} {h} {deg} {x} flat {flat}: {gap:.1e} scale {scale}", flush=True)
                continue
            worst = max(worst, gap / scale)
            status, state = ("trapped" if y[7] >= 2 else "in-flight"), [y[0], y[1], y[3], y[5]]
        else:                                     # past the end: the end's state, once
            if end.status not in (rays.GROUND, rays.SPACE):
                continue
            status, state, scale = STATUS[end.status], [end.h, end.b, end.bending, end.optical_path], 0.0
        out.append(f"{p.name},{float(h)!r},{deg!r},550,{'flat' if flat else 'sphere'},{x:g},{status},{state[0]:.7f},"
                   f"{math.degrees(state[1]):.10f},{state[2] * ARCSEC:.7f},{state[3]:.6f},{scale:.3g}")
        if status in ("ground", "space"):
            break
    return out, worst


def main(drawn):
    import hard
    rng = random.Random(f"{SEED} trace")
    airs = [a for g in drawn for a in drawn[g] if g not in ("above_air", "horizon")] + [("us76", [0.5, 30.0, 2500.0])]
    rows, worst = [], 0.0
    for name, eyes in airs:
        p, h = hard.profile(name), rng.choice(eyes)
        edges = hard.edges_deg(p, h, 550.0)
        span = 0.15 + min(1.0, 0.5 * max(abs(e) for e in edges))
        for flat in (False, False, True):
            deg = round(rng.uniform(-span, span), 5)
            more, gap = rows_of(p, h, deg, flat)
            rows, worst = rows + more, max(worst, gap)
    text = (f"# Made by tests/oracle/hard_trace.py, seed {SEED}: ODE, quadrature agrees to {worst:.1e} m over amplification.\n"
            "# amplification: |dh/da| / distance, 1 at least; 0 in the row that holds the end of a ray (ground, space).\n")
    (HARD / "trace.csv").write_text(text + HEADER + "\n" + "".join(r + "\n" for r in rows))
    print(f"trace: {len(rows)} rows, worst {worst:.1e} m", flush=True)
