"""An eye of its own: histogram adjustment (Ward Larson, Rushmeier and Piatko 1997), written from the paper and from
Radiance's documented constants, in numpy. Makes tests/data/eye/maps.csv; `check` compares with pcond's maps."""
import pathlib
import sys

import numpy as np

DATA = pathlib.Path(__file__).resolve().parent.parent / "data" / "eye"
BINS, SLACK, TINY = 100, 0.025, 1e-6
DARKEST, BRIGHTEST = 1e-7, 1e10


def threshold(luminance):
    """Just visible difference [cd/m2]: the five pieces of Ferwerda et al. 1996."""
    la = np.maximum(np.asarray(luminance, float), 1e-300)
    x = np.log10(la)
    with np.errstate(invalid="ignore"):
        pieces = [np.full_like(x, np.log10(1.38e-3)), np.power(.405 * x + 1.6, 2.18) - 2.86, x - .395,
                  np.power(.249 * x + .65, 2.7) - .72, x - 1.255]
    return 10 ** np.select([la < 1.148e-4, x < -1.44, x < -.0184, x < 1.9], pieces[:4], pieces[4])


def binned(table):
    """(low, high, counts, mean) in ln cd/m2, with the spare bottom bin."""
    b, c = np.log(10) * table[0, 0] + np.log(10) * (table[1, 0] - table[0, 0]) * np.arange(len(table)), table[:, 1]
    step = b[1] - b[0]
    some = np.flatnonzero(c > TINY)
    low, high = b[some[0]] - .001 * step, b[some[-1]] + 1.001 * step
    high = min(high, np.log(BRIGHTEST))
    spare = low >= np.log(DARKEST)
    low = high - (high - low) * BINS / (BINS - 1) if spare else np.log(DARKEST)
    inside = (b >= low + TINY) & (b < high - TINY)
    index = np.floor(BINS * (b[inside] - low) / (high - low)).astype(int)
    counts = np.bincount(index, c[inside], BINS)
    mean = np.sum(b[inside] * c[inside]) / np.sum(c[inside])
    if low > np.log(DARKEST) + TINY:
        counts[1] /= 2
        counts[0] += counts[1]
    return low, high, counts, mean


def tone_map(table, ldmax, contrast, sensitivity):
    """Rows (world, display) [cd/m2] at the bin centres, and whether the map is linear."""
    low, high, start, mean = binned(table)
    dlow, dhigh = np.log(ldmax / contrast), np.log(ldmax)
    edges = np.linspace(low, high, BINS + 1)
    centres = (edges[:-1] + edges[1:]) / 2
    counts, linear = start.copy(), high - low <= dhigh - dlow
    while not linear:
        total = counts.sum()
        if total <= SLACK * start.sum():
            linear = True
            break
        share = np.concatenate([[0], np.cumsum(counts)]) / total
        shown = dlow + np.interp(centres, edges, share) * (dhigh - dlow)
        # steepest slope dBd/db allowed, as a count in the bin
        slope = (threshold(np.exp(shown)) / np.exp(shown)) / (threshold(np.exp(centres)) / np.exp(centres)) \
            if sensitivity else np.ones(BINS)
        ceiling = slope * total * (edges[1] - edges[0]) / (dhigh - dlow)
        cut = np.maximum(counts - ceiling, 0)
        counts = counts - cut
        if cut.sum() <= SLACK * total:
            return np.column_stack([np.exp(centres), np.exp(shown)]), False
    middle, world = np.exp((dlow + dhigh) / 2), np.exp(mean)
    scale = threshold(middle) / threshold(world) if sensitivity else middle / world
    return np.column_stack([np.exp(centres), np.clip(scale * np.exp(centres), np.exp(dlow), ldmax)]), True


LIGHT = pathlib.Path(__file__).resolve().parent.parent.parent / "host" / "data"
NM = np.arange(390.0, 780.01, 0.1)


def columns(name):
    """Columns by name; comments begin with #."""
    lines = [line for line in (LIGHT / name).read_text().splitlines() if line and line[0] != "#"]
    return dict(zip(lines[0].split(","), np.array([line.split(",") for line in lines[1:]], float).T))


def low_sun(luminance):
    """Radiance [W m^-2 sr^-1 nm^-1] at whole 5 nm of a Sun on the horizon: E490 through 38 air masses of Rayleigh
    scattering, 12 of 300 DU of ozone, and haze of Angstrom exponent 1.3, as much as leaves this luminance [cd/m2]."""
    nm = np.arange(390.0, 781, 5)
    pick = lambda t, x, y: np.interp(nm, t[x], t[y])
    sun = pick(columns("solar_extraterrestrial_5nm.csv"), "nm", "E490") / 6.794e-5
    clear = sun * np.exp(-38 * pick(columns("rayleigh_5nm.csv"), "nm", "tau_sealevel_45N")
                         - 12 * pick(columns("ozone_chappuis_xsec_10nm.csv"), "nm_centre", "tau_300DU"))
    seen = lambda haze: clear * np.exp(-haze * (nm / 550) ** -1.3)
    bright = lambda haze: 683.002 * integral(np.interp(NM, nm, seen(haze)) * efficiency())
    low, high = 0.0, 50.0
    for _ in range(100):
        middle = (low + high) / 2
        low, high = (middle, high) if bright(middle) > luminance else (low, middle)
    return nm, seen(low)


def integral(values):
    return float(np.sum((values[1:] + values[:-1]) / 2 * np.diff(NM)))


def efficiency():
    v = columns("cie1931_2deg_xyz_5nm.csv")
    return np.interp(NM, v["nm"], v["y"])


def cones():
    """Energy sensitivities of L, M, S from pigment, macula and lens: CIE 170-1, 2 degrees, age 32."""
    t = columns("cone_photopigment_cie170_5nm.csv")
    at = lambda name: np.interp(NM, t["nm"], t[name])
    passed = 10 ** -(.485 * np.exp(-2 / 6.132) * at("macula_rel") + at("lens1") + at("lens2")) * NM
    peak = [.38 + .54 * np.exp(-2 / 1.333)] * 2 + [.30 + .45 * np.exp(-2 / 1.333)]
    return [(1 - 10 ** (-d * at(a))) * passed for d, a in zip(peak, ("A_L", "A_M", "A_S"))]


def cone_trolands(light):
    """Of a Sun of 0.22 deg^2, seen alone by two eyes of 28.58 years (Watson & Yellott 2012)."""
    luminance = 683.002 * integral(light * efficiency())
    flux = (luminance * .22 / 846) ** .41
    d = 7.75 - 5.75 * flux / (flux + 2)
    td = luminance * np.pi / 4 * d ** 2 * (1 - .010625 * d ** 2 + 4.1667e-5 * d ** 4)
    sensitivity = cones()
    at560 = int(np.argmin(abs(NM - 560)))
    reference = (2 * sensitivity[0][at560] + sensitivity[1][at560]) / (3 * efficiency()[at560])
    return [td * integral(light * c) / integral(light * efficiency()) / reference for c in sensitivity]


def bleached(td, seconds, steps=40000):
    """Unbleached fraction by the midpoint rule, from an eye at rest."""
    u, dt = 1.0, seconds / steps
    for _ in range(steps):
        half = u + dt / 2 * ((1 - u) / 120 - td * u / 2.4e6)
        u += dt * ((1 - half) / 120 - td * half / 2.4e6)
    return u


def looks_like(light, u):
    """Wavelength of the same ratio of L to M [nm]."""
    sensitivity = cones()
    wanted = u[0] * integral(light * sensitivity[0]) / (u[1] * integral(light * sensitivity[1]))
    some = (NM >= 475) & (NM <= 690)
    return float(np.interp(wanted, (sensitivity[0] / sensitivity[1])[some], NM[some]))


def low_suns():
    """tests/data/eye: spectra, and what an eye makes of them."""
    suns = {"clear": low_sun(1.3e5), "hazy": low_sun(550)}
    with open(DATA / "low_sun.csv", "w") as file:
        file.write("# Made by tests/oracle/eye.py: radiance [W m^-2 sr^-1 nm^-1] of a Sun on the horizon: E490 through 38 air masses of\n"
                   "# Rayleigh, 12 of 300 DU of ozone, and haze that leaves 1.3e5 and 550 cd/m2\nnm,clear,hazy\n")
        for nm, clear, hazy in zip(suns["clear"][0], suns["clear"][1], suns["hazy"][1]):
            file.write(f"{nm:g},{clear:.9g},{hazy:.9g}\n")
    with open(DATA / "low_sun_seen.csv", "w") as file:
        file.write("# Made by tests/oracle/eye.py: low_sun.csv after seconds of looking (Sun of 0.22 deg^2 alone). disk, rim: wavelength of the same\n"
                   "# ratio of L to M [nm], of the whole spectrum and of what is left below 600 nm\nclear,seconds,unbleached_L,unbleached_M,unbleached_S,disk_nm,rim_nm\n")
        for name, seconds in (("clear", 0), ("clear", 1), ("hazy", 0), ("hazy", 3)):
            light = np.interp(NM, *suns[name])
            u = [bleached(td, seconds) if seconds else 1.0 for td in cone_trolands(light)]
            rim = np.where(NM < 600 - 1e-6, light, 0)
            file.write(f"{int(name == 'clear')},{seconds}," + ",".join(f"{value:.6f}" for value in u) +
                       f",{looks_like(light, u):.3f},{looks_like(rim, u):.3f}\n")


def histograms():
    """Shapes that pcond's own example does not have: name -> (log10 cd/m2, count)."""
    random = np.random.default_rng(5)
    x = np.linspace(-6, 6, 121)
    gauss = lambda m, s: np.exp(-.5 * ((x - m) / s) ** 2)
    yield "two_peaks", np.column_stack([x, np.round(4000 * gauss(-3.5, .8) + 900 * gauss(3.2, .25), 3)])
    yield "night", np.column_stack([np.linspace(-5, .5, 40), np.round(random.uniform(0, 10, 40), 3)])
    yield "spikes", np.column_stack([x, np.where(np.arange(121) % 17 == 3, 100 + np.arange(121), 0)])
    sun = np.round(50 * gauss(-1, 1.5), 3)
    sun[118] = 7
    yield "sun", np.column_stack([x, sun])
    yield "narrow", np.column_stack([np.linspace(1, 2.2, 13), np.arange(13) + 1.])
    yield "below", np.column_stack([np.linspace(-9, -2, 36), np.full(36, 3.)])
    yield "flat_long", np.column_stack([np.linspace(-6.5, 6.5, 27), np.full(27, 2.)])


def write():
    with open(DATA / "maps.csv", "w", encoding="ascii") as out:
        out.write("# tests/oracle/eye.py\nhistogram,ldmax,contrast,sensitivity,linear,bin,world_cd_m2,display_cd_m2\n")
        for name, table in histograms():
            np.savetxt(DATA / f"hist_{name}.txt", table, fmt="%.6f")
            table = np.loadtxt(DATA / f"hist_{name}.txt")
            for ldmax, contrast in ((100, 100), (250, 1000), (80, 30)):
                for sensitivity in (0, 1):
                    rows, linear = tone_map(table, ldmax, contrast, sensitivity)
                    for i in range(0, BINS, 9):
                        out.write(f"{name},{ldmax},{contrast},{sensitivity},{int(linear)},{i},"
                                  f"{rows[i, 0]:.9e},{rows[i, 1]:.9e}\n")


def check():
    table, worst = np.loadtxt(DATA / "hist_a.txt"), 0
    for letter in "ns":
        for ldmax, contrast in ((100, 100), (250, 1000)):
            known = np.loadtxt(DATA / f"histI_a_{letter}_u{ldmax}d{contrast}.map.txt")
            rows, linear = tone_map(table, ldmax, contrast, letter == "s")
            worst = max(worst, np.max(np.abs(rows / known - 1)))
            assert not linear
    print(f"largest relative difference to pcond's maps: {worst:.2e}")
    return worst < 1e-6


if __name__ == "__main__":
    if sys.argv[1:] == ["write"]:
        write()
        low_suns()
    sys.exit(0 if check() else 1)
