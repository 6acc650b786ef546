"""Checks the oracle against what is published or supplied, and prints the largest deviation of each.

python verify.py [FOLDER]   FOLDER: the supplied reference tables (standard_h2m.csv, inversion_*.csv, analytic_*.csv).
Without FOLDER the subset kept in tests/data/reference is used.
"""
import csv
import math
import sys
import tempfile
from pathlib import Path

import numpy as np
from scipy.integrate import solve_ivp

import rays
from air import Profile, ciddor_mole_fraction, ciddor_refractivity, dispersion
from rays import ARCSEC, STATUS

DATA = Path(__file__).resolve().parent.parent / "data" / "reference"

# Ciddor 1996 tables 1-3: t C, P Pa, humidity (Pa of vapour if > 1, else relative), CO2 ppm, (n-1) 1e8 at 633 nm.
# Table 3, 40 C, 80 kPa prints 19996.5; its own difference column shows that 19896.5 is meant.
CIDDOR = [(20, 80e3, 0, 450, 21458.0), (20, 100e3, 0, 450, 26824.4), (20, 120e3, 0, 450, 32191.6),
          (10, 100e3, 0, 450, 27774.7), (30, 100e3, 0, 450, 25937.2), (19.526, 102094.8, 1065, 510, 27392.9),
          (19.517, 102096.8, 1065, 510, 27394.0), (19.173, 102993.0, 641, 450, 27682.4),
          (19.173, 103006.0, 642, 440, 27685.8), (19.188, 102918.8, 706, 450, 27658.7),
          (19.189, 102927.8, 708, 440, 27660.8), (19.532, 103603.2, 986, 600, 27802.0),
          (19.534, 103596.2, 962, 600, 27800.8), (19.534, 103599.2, 951, 610, 27802.2),
          (20, 80e3, 0.75, 450, 21394.0), (20, 120e3, 0.75, 450, 32127.8), (40, 80e3, 0.75, 450, 19896.5),
          (40, 120e3, 0.75, 450, 29941.8), (50, 80e3, 1.0, 450, 19058.4), (50, 120e3, 1.0, 450, 28792.4)]
# NIST Engineering Metrology Toolbox, Ciddor column: t C, P kPa, RH, nm, n (its vapour pressure is IAPWS, not Ciddor's).
NIST = [(20, 101.325, 0, 633, 1.000271800), (20, 60, 0, 633, 1.000160924), (20, 120, 0, 633, 1.000321916),
        (50, 100, 0, 633, 1.000243285), (5, 100, 0, 633, 1.000282756), (-40, 100, 0, 633, 1.000337580),
        (50, 120, 1.0, 633, 1.000287924), (40, 120, 0.75, 633, 1.000299418), (20, 100, 1.0, 633, 1.000267394),
        (40, 110, 1.0, 1700, 1.000270247), (20, 101.325, 0, 1700, 1.000268479), (40, 110, 1.0, 300, 1.000289000),
        (20, 101.325, 0, 300, 1.000286581), (-40, 120, 0, 300, 1.000427233)]


def read(path):
    return list(csv.DictReader(line for line in path.read_text().splitlines() if line and line[0] != "#"))


def ciddor():
    worst = 0.0
    for t, P, wet, co2, want in CIDDOR:
        T = t + 273.15
        rh = wet if wet <= 1 else wet / math.exp(1.2378847e-5 * T * T - 1.9121316e-2 * T + 33.93711047 - 6343.1645 / T)
        got = 1e8 * ciddor_refractivity(T, P, ciddor_mole_fraction(T, P, rh), *dispersion("ciddor", 633.0), co2)
        worst = max(worst, abs(got - want))
    print(f"Ciddor 1996 tables 1-3: {len(CIDDOR)} values, max deviation {worst:.3f}e-8 (printed to 0.1e-8)")
    dev = [(abs(1 + ciddor_refractivity(t + 273.15, 1e3 * P, ciddor_mole_fraction(t + 273.15, 1e3 * P, rh),
                                        *dispersion("ciddor", float(nm)), 450.0) - n), rh) for t, P, rh, nm, n in NIST]
    print(f"NIST toolbox: dry {max(d for d, rh in dev if not rh):.2e}, humid {max(d for d, rh in dev if rh):.2e}")


def known_answers():
    p, worst = Profile(), 0.0
    for r in read(DATA / "known_answers.csv"):
        got = rays.quad(p, 0.0, math.radians(float(r["apparent_altitude_deg"])), float(r["wavelength_nm"])).bending
        worst = max(worst, abs(got * ARCSEC - float(r["refraction_arcsec"])))
    print(f"known answers: max deviation {worst:.1e} arcsec")
    for h, arcmin in ((2.0, 2.48), (1000.0, 55.7)):
        from tables import grazing_deg
        print(f"dip of the horizon from {h:g} m: {-60 * grazing_deg(p, h, 550.0):.3f}', known {arcmin}'")


def compare(p, rows):
    """Worst scaled differences of quad (and every 20th row of ode) from supplied rows."""
    worst = dict.fromkeys(("space", "ground", "h_min", "distance", "dRda", "ode"), 0.0)
    wrong = 0
    for i, r in enumerate(rows):
        h, deg, nm = (float(r[k]) for k in ("h_obs_m", "apparent_altitude_deg", "lambda_nm"))
        q = rays.quad(p, h, math.radians(deg), nm)
        if STATUS[q.status] != r["status"] or q.turning != int(r["turning_points"]):
            wrong += 1
            print("   ", r, q)
            continue
        if q.status == rays.TRAPPED:
            continue
        scale = max(1.0, abs(float(r["dRda"] or 0)))
        want = float(r["refraction_arcsec"])
        key = r["status"]
        worst[key] = max(worst[key], abs(q.bending * ARCSEC - want) / scale)
        worst["h_min"] = max(worst["h_min"], abs(q.h_min - float(r["h_min_m"])))
        worst["distance"] = max(worst["distance"], abs(q.distance - float(r["ground_distance_m"])) / scale)
        if i % 20 == 0:
            worst["ode"] = max(worst["ode"], abs(rays.ode(p, h, math.radians(deg), nm).bending * ARCSEC - want) / scale)
            mine = rays.dRda(p, h, deg, nm) if r["dRda"] else None
            if mine is not None:
                worst["dRda"] = max(worst["dRda"], abs(mine / float(r["dRda"]) - 1))
    print(f"  {len(rows)} rows, {wrong} status differences; " + ", ".join(f"{k} {v:.1e}" for k, v in worst.items()))


def supplied(folder):
    wide = [s.split(",") for s in (folder / "standard_h2m.csv").read_text().splitlines() if s and s[0] != "#"]
    nms, n = [float(x[2:].removesuffix("nm_arcsec")) for x in wide[0][1:]], 0
    p, worst = Profile(), 0.0
    for f in wide[1:]:
        for nm, want in zip(nms, f[1:]):
            if want:
                q = rays.quad(p, 2.0, math.radians(float(f[0])), nm)
                worst, n = max(worst, abs(q.bending * ARCSEC - float(want))), n + 1
    print(f"standard_h2m.csv, at 2 m: {n} values, max deviation {worst:.1e} arcsec")
    for path in sorted(folder.glob("inversion_*.csv")):
        print(path.name + ":")
        with tempfile.TemporaryDirectory() as tmp:
            toml = Path(tmp) / "doublesun.toml"
            toml.write_text("[[inversion]]\ndelta_T_K = -3.0\nheight_m = 4.0\ndiffuseness_m = 1.0\n")
            compare(Profile(toml), read(path))


def analytic(folder):
    """The closed forms against a Cartesian ODE d2r/dsigma2 = grad(n^2)/2 that knows none of them."""
    for name in ("analytic_linear_n2.csv", "analytic_luneburg.csv"):
        worst = 0.0
        for r in read(folder / name):
            v = {k: float(x) for k, x in r.items()}
            r0 = np.array([v["x0"], v["y0"], v["z0"]])
            d0 = np.array([v["dx0"], v["dy0"], v["dz0"]])
            if "gx" in v:
                g = np.array([v["gx"], v["gy"], v["gz"]])
                n2, half = (lambda x: 2 + g @ x), (lambda x: g / 2)
            else:
                n2, half = (lambda x: 2 - x @ x), (lambda x: -x)
            y0 = np.concatenate([r0, math.sqrt(n2(r0)) * d0, [0.0]])
            y = solve_ivp(lambda s, y: np.concatenate([y[3:6], half(y[:3]), [n2(y[:3])]]), (0, v["sigma"]), y0,
                          "DOP853", rtol=1e-13, atol=1e-14).y[:, -1]
            got = np.concatenate([y[:3], y[3:6] / np.linalg.norm(y[3:6]), [y[6]]])
            worst = max(worst, np.abs(got - [v[k] for k in ("x1", "y1", "z1", "dx1", "dy1", "dz1", "opl")]).max())
        print(f"{name}: max deviation {worst:.1e}")


def main():
    folder = Path(sys.argv[1]) if len(sys.argv) > 1 else DATA / "supplied"
    ciddor()
    known_answers()
    supplied(folder)
    analytic(folder)


if __name__ == "__main__":
    main()
