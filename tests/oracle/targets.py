"""Writes target_sights.csv and mirage_scenes.csv: python targets.py. What an upright target at a distance looks like.

For an eye in stratified air, the height above the surface at which the ray of each apparent altitude passes a distance,
by route (a) of rays.py (Dormand-Prince 8(5,3) in arc length, P integrated along); blank where it met the ground before.
"""
import math

from air import Profile
from rays import ode
from tables import DATA, profile, write

CASES = [  # profile, eye m, distance m, altitudes from, to, step deg: a road; a cold layer that lifts and inverts
    ("hot_road_thin", 1.5, 800.0, -0.36, 0.12, 0.0005),
    ("duct_10K", 15.0, 25000.0, -0.30, 0.45, 0.001),
]
NM = 550.0


# Shipped scenes: eye and target, the altitudes to look through, and a height whose images are counted.
SCENES = [  # scene, profile, eye m, distance m, altitudes from, to, step deg, height counted m
    ("inferior-mirage", "hot-road", 1.5, 900.0, -0.26, 0.05, 0.002, 0.7),
    ("superior-mirage", "superior-mirage", 16.0, 25000.0, -0.15, 0.25, 0.001, 30.0),
    ("fata-morgana", "fata-morgana", 10.0, 25000.0, -0.15, 0.30, 0.0005, 20.0),
    ("hillingar", "looming", 15.0, 60000.0, -0.10, 0.15, 0.002, 40.0),
    ("hillingar us76", "us76", 15.0, 60000.0, -0.15, 0.15, 0.002, 160.0),
    ("sinking", "sinking", 10.0, 25000.0, -0.15, 0.10, 0.002, 30.0),
    ("sinking us76", "us76", 10.0, 25000.0, -0.15, 0.10, 0.002, 30.0),
]
PROFILES = DATA.parents[2] / "profiles"


def golden(f, a, b, sign):
    """Place of an extreme of f in a..b: a maximum for sign 1."""
    ratio = (math.sqrt(5) - 1) / 2
    while b - a > 1e-6:
        c, d = b - ratio * (b - a), a + ratio * (b - a)
        if sign * f(c) > sign * f(d):
            b = d
        else:
            a = c
    return 0.5 * (a + b)


def figures(case):
    """Rows: the lowest ray that passes the target, every fold, and how many images a height has."""
    name, air, eye, distance, low, high, step, counted = case
    p = Profile("us76" if air == "us76" else PROFILES / f"{air}.toml")

    def height(deg):
        _, at = ode(p, eye, math.radians(deg), NM, stops=(distance,))
        return at[0][0] if len(at) else -1.0

    grid = [low + i * step for i in range(round((high - low) / step) + 1)]
    h = [height(deg) for deg in grid]
    row = lambda what, deg, m: f"{name},{eye:g},{distance:g},{what},{deg:.5f},{m:.3f}"
    rows = []
    for i in range(1, len(grid)):
        if h[i - 1] < 0 <= h[i]:
            a, b = grid[i - 1], grid[i]
            while b - a > 1e-7:
                a, b = (a, 0.5 * (a + b)) if height(0.5 * (a + b)) >= 0 else (0.5 * (a + b), b)
            rows.append(row("begins", b, height(b)))
        if i + 1 < len(grid) and min(h[i - 1:i + 2]) >= 0 and (h[i] - h[i - 1]) * (h[i + 1] - h[i]) < 0:
            sign = 1 if h[i] > h[i - 1] else -1
            deg = golden(height, grid[i - 1], grid[i + 1], sign)
            rows.append(row("highest" if sign > 0 else "lowest", deg, height(deg)))
    images = sum(1 for a, b in zip(h, h[1:]) if a >= 0 and b >= 0 and (a < counted) != (b < counted))
    rows.append(f"{name},{eye:g},{distance:g},images of {counted:g} m,{images},{counted:g}")
    return rows


def scenes():
    write("mirage_scenes.csv",
          ["Made by tests/oracle/targets.py (rays.py, ODE) at 550 nm: targets of shipped scenes through shipped profiles.",
           "begins: the lowest of a run of rays that pass the target's distance above the surface; highest, lowest: folds,",
           "where the height that is seen turns back. images: how often a height is seen (number in place of altitude)."],
          "scene,eye_m,distance_m,what,altitude_deg,height_m", [r for case in SCENES for r in figures(case)])


def main():
    scenes()
    rows = []
    for name, eye, distance, low, high, step in CASES:
        p = profile(name)
        for i in range(round((high - low) / step) + 1):
            deg = low + i * step
            _, at = ode(p, eye, math.radians(deg), NM, stops=(distance,))
            passed = f"{at[0][0]:.6f},{int(at[0][7])}" if len(at) else ","
            rows.append(f"{name},{eye:g},{NM:g},{distance:g},{deg:.4f},{passed}")
    write("target_sights.csv",
          ["Made by tests/oracle/targets.py (rays.py, ODE): height above the surface at which a ray passes a distance.",
           "height_at_distance_m is blank where the ray met the ground before."],
          "profile,height_m,wavelength_nm,distance_m,apparent_altitude_deg,height_at_distance_m,turning_points", rows)


if __name__ == "__main__":
    main()
