"""Writes the reference tables: python tables.py [us76 states standard humid inversions trace suns] (all when none named).
Needs: pip install numpy scipy numba mpmath (in a virtual environment; not a dependency of greenray).

Each refraction row is computed by both routes of rays.py and kept only if they agree to 1e-6 arcsec * max(1, |dR/da|).
"""
import math
import random
import sys
from pathlib import Path

import mpmath

import rays
from air import US76_BASES, US76_LAPSES, Profile
from rays import ARCSEC, STATUS, TRAPPED

DATA = Path(__file__).resolve().parent.parent / "data" / "reference"
REFRACTION_HEADER = ("profile,height_m,apparent_altitude_deg,wavelength_nm,status,refraction_arcsec,true_altitude_deg,"
                     "air_mass,min_height_m,max_height_m,ground_distance_m,turning_points,dRda")


def profile(name, **kw):
    return Profile(name if name == "us76" else DATA / "profiles" / f"{name}.toml", **kw)


def write(name, comments, header, rows):
    text = "".join(f"# {c}\n" for c in comments) + header + "\n" + "".join(r + "\n" for r in rows)
    (DATA / name).write_text(text)
    print(f"{name}: {len(rows)} rows, {len(text) // 1024} KiB", flush=True)


# ---- US76 boundaries ------------------------------------------------------------------------------------

def us76():
    """Closed forms in 50 digits beside the published pressure ratios (to ground) of the standard's base levels."""
    printed = ["1.0", "2.2336110E-1", "5.4032950E-2", "8.5666784E-3", "1.0945601E-3", "6.6063531E-4",
               "3.9046834E-5", "3.68501E-6"]
    mpmath.mp.dps = 50
    k = mpmath.mpf("9.80665") * mpmath.mpf("28.9644") / mpmath.mpf("8314.32")
    T, P, rows = mpmath.mpf("288.15"), mpmath.mpf(101325), []
    for i, H in enumerate(US76_BASES):
        if i:
            L, dH = mpmath.mpf(str(US76_LAPSES[i - 1])), mpmath.mpf(H - US76_BASES[i - 1])
            T1 = T + L * dH
            P *= mpmath.exp(-k * dH / T) if L == 0 else (T1 / T) ** (-k / L)
            T = T1
        Z = mpmath.mpf(6356766) * H / (6356766 - mpmath.mpf(H))
        rows.append(",".join([f"{H:.0f}", mpmath.nstr(Z, 16), mpmath.nstr(T, 15), mpmath.nstr(P, 15), printed[i]]))
    write("us76_boundaries.csv",
          ["US Standard Atmosphere 1976 at its layer boundaries. T (molecular-scale) and P: closed form, 15 digits, with",
           "K = g0 M0/R* = 9.80665 * 28.9644 / 8314.32 K/m. Last column: published P/P0 of the base levels (Carmichael, PDAS,",
           "after NASA-TM-X-74335), computed there with 0.034163195 K/m, printed to 6-8 digits."],
          "geopotential_m,height_m,temperature_K,pressure_Pa,published_pressure_ratio", rows)


# ---- the air itself ----------------------------------------------------------------------------------------

def states():
    """T, P, density, n-1 and its gradient at heights off the kinks; columns of `greenray profile`."""
    rows = []
    for name in ["us76", "iag1999", "peck_reeder", "ciddor_dry", "ciddor_humid", "warm_sea", "two_inversions", "linear_levels",
                 "cubic_levels", "late_levels", "other_constants"]:
        p = profile(name)
        for h in (0.0, 0.3, 5.0, 19.5, 24.7, 45.0, 84.0, 350.0, 1234.5, 9000.0, 15000.0, 40000.0, 90000.0, 119000.0):
            for nm in (400.0, 550.0, 700.0):
                T, P, rho, N, dN = p.state(h, nm)
                rows.append(f"{p.name},{h:g},{T:.10g},{P:.12g},{rho:.10g},{nm:g},{N:.12g},{dN:.10g}")
    write("profile_states.csv", ["Made by tests/oracle/tables.py: the air of each profile; density = P M0/(R* T)."],
          "profile,height_m,temperature_K,pressure_Pa,density_kg_m3,wavelength_nm,refractivity,refractivity_gradient_per_m",
          rows)


# ---- refraction -------------------------------------------------------------------------------------------

def grazing_deg(p, h, nm):
    """Apparent altitude of the ray that just touches h = 0, deg (stratified air whose n r rises all the way down to up)."""
    n0, nh = 1 + p.state(0.0, nm)[3], 1 + p.state(h, nm)[3]
    return -math.degrees(math.acos(n0 * p.earth_radius / (nh * (p.earth_radius + h))))


_COLUMN = {}
WORST = {"routes": 0.0}


def refraction_row(p, h, deg, nm):
    b = math.radians(deg)
    q, o = rays.quad(p, h, b, nm), rays.ode(p, h, b, nm)
    key = (p.serial, h)
    if key not in _COLUMN:
        _COLUMN[key] = rays.quad(p, h, math.pi / 2, nm).column
    slope = rays.dRda(p, h, deg, nm) if q.status != TRAPPED else None
    scale = max(1.0, abs(slope or 0.0))
    gap = abs(q.bending - o.bending) * ARCSEC / scale
    if (q.status, q.turning) != (o.status, o.turning) or gap > 1e-6:
        print(f"routes differ, row left out: {p.name} {h} {deg} {nm}: {q} {o}", flush=True)
        return None
    WORST["routes"] = max(WORST["routes"], gap)
    r = "" if q.status == TRAPPED else f"{q.bending * ARCSEC:.7f}"
    true = f"{deg - math.degrees(q.bending):.9f}" if q.status == rays.SPACE else ""
    mass = "" if q.status == TRAPPED else f"{q.column / _COLUMN[key]:.8g}"
    dist = "" if q.status == TRAPPED else f"{q.distance:.4f}"
    return (f"{p.name},{h:g},{deg:.10g},{nm:g},{STATUS[q.status]},{r},{true},{mass},{q.h_min:.6f},{q.h_max:.6f},{dist},"
            f"{q.turning}," + ("" if slope is None else f"{slope:.5g}"))


COMMENTS = ["Made by tests/oracle/tables.py: two independent routes agree to {gap:.1e} arcsec (over max(1, |dRda|)).",
            "Columns as `greenray refraction`, plus profile, height and dRda = d(refraction)/d(apparent altitude).",
            "Rules: see README.md. dRda blank where a kink or an edge makes it undefined; refraction blank when trapped."]


def refraction_table(name, jobs):
    WORST["routes"] = 0.0
    rows = [r for p, h, deg, nm in jobs if (r := refraction_row(p, h, deg, nm))]
    write(name, [c.format(gap=WORST["routes"]) for c in COMMENTS], REFRACTION_HEADER, rows)


HIGH = [89.9, 60, 30, 10, 3, 1, 0.3, 0.1, 0.01, 0]


def below(p, h):
    """Altitudes below the horizontal: down to just above the sea horizon, just below it, and steeply to the ground."""
    if h <= 0:
        return [-0.1]
    g = grazing_deg(p, h, 550)
    steps = [g * 0.3, g * 0.7, g * 0.95, g + 0.0005, g - 0.0005, g - 0.02, g - 0.3, g - 3, g - 30]
    return [round(a, 6) for a in steps]


def standard():
    p, jobs = profile("us76"), []
    for h in (0, 0.5, 2, 60, 1000, 3000, 10000, 40000):
        jobs += [(p, float(h), a, nm) for a in HIGH + below(p, h) for nm in (400, 550, 700)]
    for name in ("iag1999", "peck_reeder", "ciddor_dry", "ciddor_humid"):
        p = profile(name)
        for h in (2.0, 1000.0):
            jobs += [(p, h, a, nm) for a in HIGH[1:] + below(p, h) for nm in (400, 550, 700)]
    refraction_table("refraction_standard.csv", jobs)


def humid():
    """The humid profile once more with moist air's own weight in the hydrostatic balance (virtual temperature)."""
    p = profile("ciddor_humid", virtual=True)
    refraction_table("refraction_humid_virtual.csv",
                     [(p, h, a, nm) for h in (2.0, 1000.0) for a in HIGH[1:] for nm in (400, 550, 700)])


INVERSIONS = {"thin_fermi": (2, 9.6, 12, 40), "duct_10K": (20, 50, 57, 90), "hot_road_thin": (1.5,),
              "hot_road_thick": (0.3, 1.5), "warm_sea": (3, 15), "two_inversions": (2, 22.5, 32),
              "linear_levels": (5, 70, 100, 180), "cubic_levels": (5, 70, 100, 180), "late_levels": (3, 45, 120),
              "other_constants": (2, 75, 120), "arctic_duct": (30, 110)}


def inversions():
    jobs = []
    for name, heights in INVERSIONS.items():
        p = profile(name)
        for h in heights:
            rng = random.Random(f"{name} {h}")
            dip = math.degrees(math.sqrt(2 * h / 6371000.0))
            span = (0.55 if name.startswith("hot_road") else 0.25) + dip
            near = sorted({round(rng.uniform(-span, span), 5) for _ in range(34)} | {0.0, 0.5, 2.0, 20.0})
            for i, a in enumerate(near):
                jobs += [(p, float(h), a, nm) for nm in ((400, 550, 700) if i % 4 == 0 else (550,))]
    refraction_table("refraction_inversions.csv", jobs)


# ---- trace -------------------------------------------------------------------------------------------------

def trace_rows(p, h, deg, nm, flat, stops):
    """One row per distance, by the ODE, each checked by the quadrature stopped at the same distance."""
    end, rows = rays.ode(p, h, math.radians(deg), nm, stops, flat)
    out = []
    for i, x in enumerate(stops):
        if i < len(rows):
            y = rows[i]
            q = rays.quad(p, h, math.radians(deg), nm, x, flat)
            gaps = (abs(q.h - y[0]), abs(q.bending - y[3]) * ARCSEC, abs(q.optical_path - y[5]))
            if q.status != rays.FLIGHT or gaps[0] > 1e-5 or gaps[1] > 1e-4 or gaps[2] > 1e-6:
                print(f"trace routes differ, row left out: {p.name} {h} {deg} {x} {flat} {gaps} {q.status}", flush=True)
                continue
            WORST["trace"] = [max(a, b) for a, b in zip(WORST.get("trace", (0, 0, 0)), gaps)]
            state = ["in-flight", y[0], y[1], y[3], y[5]]
            trapped = int(y[7]) >= 2
        else:
            state = [STATUS[end.status], end.h, end.b, end.bending, end.optical_path]
            trapped = False
        name = "trapped" if trapped else state[0]
        out.append(f"{p.name},{h:g},{deg:g},{nm:g},{'flat' if flat else 'sphere'},{x:g},{name},{state[1]:.6f},"
                   f"{math.degrees(state[2]):.9f},{state[3] * ARCSEC:.6f},{state[4]:.6f}")
    return out


TRACES = [("us76", 2, (-0.5, -0.03, 0, 0.2, 5)), ("us76", 1000, (-5, -0.9, 0, 1)), ("thin_fermi", 12, (-0.1, 0, 0.07)),
          ("duct_10K", 45, (-0.2, -0.05, 0.02, 0.3)), ("hot_road_thick", 1.5, (-0.3, -0.12, 0.1)),
          ("linear_levels", 70, (-0.2, 0.01, 0.2)), ("cubic_levels", 70, (-0.2, 0.01, 0.2)),
          ("weak_laboratory", 20, (-0.1, 0.0, 0.15, 1.5))]


def trace():
    rows = []
    for name, h, altitudes in TRACES:
        p = profile(name)
        for flat in (False, True):
            for a in altitudes:
                for nm in (450, 650):
                    rows += trace_rows(p, float(h), float(a), nm, flat, [1000.0, 10000.0, 50000.0, 200000.0])
    p = profile("laboratory")
    for a in (-30, -5, 10, 40):
        rows += trace_rows(p, 1.5, float(a), 450, True, [1.0, 4.0, 10.0, 40.0])
    gap = WORST["trace"]
    write("trace_terrestrial.csv",
          ["Made by tests/oracle/tables.py; ODE, checked by quadrature: height to %.1e m, bending %.1e arcsec, path %.1e m." % tuple(gap),
           "Rows past the end of a ray hold its end state (status ground or space). trapped: an upper and a lower turning",
           "point lie before this distance; the values are still those at the distance."],
          "profile,height_m,apparent_altitude_deg,wavelength_nm,surface,distance_m,status,end_height_m,elevation_deg,"
          "bending_arcsec,optical_path_m", rows)


def main():
    names = sys.argv[1:] or ["us76", "states", "standard", "humid", "inversions", "trace", "suns"]
    for name in names:
        if name == "suns":
            import suns
            suns.main()
        else:
            {"us76": us76, "states": states, "standard": standard, "humid": humid, "inversions": inversions, "trace": trace}[name]()


if __name__ == "__main__":
    main()
