"""Numbers for rendered Suns from the transfer curve t(a) = a - R(a): flattening and upper-rim widths.

Definitions are in tests/data/reference/README.md, "sun_shapes.csv".
"""
import math

from scipy.optimize import brentq, minimize_scalar

import rays
import tables

RADIUS = 959.63 / rays.ARCSEC                    # of the Sun's disc, rad


def true_altitude(p, h, a, nm):
    """rad; the ray must reach space."""
    ray = rays.quad(p, h, a, nm)
    if ray.status != rays.SPACE:
        raise ValueError(f"{h} {math.degrees(a)} {nm} ends at the {rays.STATUS[ray.status]}")
    return a - ray.bending


def apparent_altitude(p, h, t, nm, lowest):
    """The apparent altitude a >= lowest with t(a) = t (US76: t(a) rises all the way), rad."""
    if abs(true_altitude(p, h, lowest, nm) - t) < 1e-12:
        return lowest
    return brentq(lambda a: true_altitude(p, h, a, nm) - t, lowest, lowest + 0.2, xtol=1e-14)


def horizon(p, h, nm):
    """Apparent altitude of the sea horizon, rad, raised by 1e-9 deg so that the ray passes."""
    if h == 0:
        return 0.0
    return math.radians(tables.grazing_deg(p, h, nm) + 1e-9)


def half_width(p, h, a, centre, nm):
    """Apparent half width of the disc at apparent altitude a: azimuth of the limb times cos a, rad; 0 outside."""
    t = true_altitude(p, h, a, nm)
    s = math.sin(RADIUS / 2) ** 2 - math.sin((t - centre) / 2) ** 2
    if s <= 0:
        return 0.0
    return 2 * math.asin(math.sqrt(s / (math.cos(t) * math.cos(centre)))) * math.cos(a)


def flattening(p, h, nm):
    low = horizon(p, h, nm)
    bottom = true_altitude(p, h, low, nm)
    high = apparent_altitude(p, h, bottom + 2 * RADIUS, nm, low)
    best = minimize_scalar(lambda a: -half_width(p, h, a, bottom + RADIUS, nm), bounds=(low, high), method="bounded",
                           options={"xatol": 1e-10})
    v, w = (high - low) * rays.ARCSEC, -2 * best.fun * rays.ARCSEC
    return (f"flattening,{h:g},{nm:g},,lower limb on the sea horizon,{math.degrees(bottom + RADIUS):.8f},"
            f"{math.degrees(low):.8f},{math.degrees(high):.8f},{v:.4f},{w:.4f},{v / w:.6f}")


def rim(p, h, what, top, short=520.0, long=650.0):
    """Difference of the apparent upper limbs at two wavelengths, true altitude of the limb fixed (rad)."""
    a, b = (apparent_altitude(p, h, top, nm, horizon(p, h, nm)) for nm in (short, long))
    return (f"rim,{h:g},{short:g},{long:g},{what},{math.degrees(top - RADIUS):.8f},{math.degrees(b):.8f},"
            f"{math.degrees(a):.8f},{(a - b) * rays.ARCSEC:.4f},,")


def main():
    p = tables.profile("us76")
    rows = [flattening(p, h, 550.0) for h in (0.5, 2.0, 60.0, 1000.0, 3000.0)]
    for h in (0.0, 2.0):
        rows.append(rim(p, h, "650 nm upper limb at apparent altitude 0", true_altitude(p, h, 0.0, 650.0)))
        rows.append(rim(p, h, "upper limb at true altitude 1 deg", math.radians(1.0)))
    for h in (2.0, 1000.0):
        rows.append(rim(p, h, "650 nm upper limb on the sea horizon", true_altitude(p, h, horizon(p, h, 650.0), 650.0)))
    tables.write("sun_shapes.csv",
                 ["Made by tests/oracle/suns.py from R(a) of us76; Sun's diameter 2 x 959.63 arcsec. Definitions: README.md.",
                  "flattening: low/high are the apparent limbs, vertical/horizontal the apparent diameters.",
                  "rim: low/high are the upper limbs at wavelength_b and wavelength, vertical their difference."],
                 "kind,height_m,wavelength_nm,wavelength_b_nm,case,true_centre_altitude_deg,low_apparent_deg,"
                 "high_apparent_deg,vertical_arcsec,horizontal_arcsec,flattening", rows)


if __name__ == "__main__":
    main()
