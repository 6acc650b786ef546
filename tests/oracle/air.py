"""Air for the oracle: T(h), hydrostatic P(h) and refractivity n-1, from the physics alone.

Nothing here is shared with greenray itself.  Temperatures K, pressures Pa, heights geometric metres,
wavelengths nm.  Every formula is written for complex h, so that derivatives are exact complex steps:
f'(h) = Im f(h + i e)/e, with no hand-derived derivative that could repeat a mistake.
"""
import itertools
import math
import tomllib
from pathlib import Path

import numpy as np
from numba import njit

R0_GEOPOTENTIAL = 6356766.0      # m, US76
K_HYDROSTATIC = 9.80665 * 28.9644 / 8314.32   # K/m, g0 M0/R* of US76 = 0.03416319474 (0.0341631947 moves R by 2e-6")
TOP_M = 120000.0                 # end of the air
US76_BASES = [0.0, 11000.0, 20000.0, 32000.0, 47000.0, 51000.0, 71000.0, 84852.0]
US76_LAPSES = [-0.0065, 0.0, 0.001, 0.0028, 0.0, -0.0028, -0.002, 0.0]
MODELS = {"born-wolf": 0, "iag1999": 1, "peck-reeder": 2, "ciddor": 3, "index_level": 4}
STEP = 1e-30                     # complex step
CHEB = 20                        # degree of ln P per cell

US76_T = [288.15]
for _i in range(7):
    US76_T.append(US76_T[_i] + US76_LAPSES[_i] * (US76_BASES[_i + 1] - US76_BASES[_i]))


def geometric(H):
    return R0_GEOPOTENTIAL * H / (R0_GEOPOTENTIAL - H)


def us76_temperature(h):
    """T of US76 at geometric height h, plain floats (for joining levels)."""
    H = R0_GEOPOTENTIAL * h / (R0_GEOPOTENTIAL + h)
    i = max(k for k in range(8) if US76_BASES[k] <= H + 1e-9)
    return US76_T[i] + US76_LAPSES[i] * (H - US76_BASES[i])


# ---- refractive index of the air that each model's constants describe ---------------------------------

def dispersion(model, nm):
    """(dry term, water-vapour term): n-1 of the model's reference air and, for ciddor, of its reference vapour."""
    s = (1000.0 / nm) ** 2                                                        # um^-2
    if model == "born-wolf":
        return 28.79e-5 * (1 + 5.67e-3 * s), 0.0                                  # 0 C, 101325 Pa
    if model == "iag1999":
        return (287.6155 + 1.62887 * s + 0.01360 * s * s) * 1e-6, 0.0             # 0 C, 101325 Pa
    if model == "peck-reeder":
        return 0.05791817 / (238.0183 - s) + 0.00167909 / (57.362 - s), 0.0       # 15 C, 101325 Pa
    if model == "ciddor":                                                         # 15 C, 101325 Pa, 450 ppm CO2
        dry = 1e-8 * (5792105.0 / (238.0185 - s) + 167917.0 / (57.362 - s))
        wet = 1.022e-8 * (295.235 + 2.6422 * s - 0.032380 * s**2 + 0.004028 * s**3)
        return dry, wet
    raise ValueError(model)


@njit(cache=True)
def ciddor_z(T, P, x):
    """Compressibility of moist air (Ciddor 1996, appendix A; BIPM 1981/91)."""
    t = T - 273.15
    a = 1.58123e-6 - 2.9331e-8 * t + 1.1043e-10 * t * t
    b = 5.707e-6 - 2.051e-8 * t
    c = 1.9898e-4 - 2.376e-6 * t
    q = P / T
    return 1 - q * (a + b * x + c * x * x) + q * q * (1.83e-11 - 0.765e-8 * x * x)


@njit(cache=True)
def ciddor_mole_fraction(T, P, rh):
    """Water-vapour mole fraction for a relative humidity over liquid water."""
    svp = np.exp(1.2378847e-5 * T * T - 1.9121316e-2 * T + 33.93711047 - 6343.1645 / T)
    t = T - 273.15
    return rh * svp / P * (1.00062 + 3.14e-8 * P + 5.6e-7 * t * t)


@njit(cache=True)
def ciddor_refractivity(T, P, x, dry, wet, co2_ppm):
    """n-1 by Ciddor 1996: densities of both components against their reference states (molar form)."""
    dry = dry * (1 + 0.534e-6 * (co2_ppm - 450.0))
    za = ciddor_z(288.15, 101325.0, 0.0)
    zw = ciddor_z(293.15, 1333.0, 1.0)
    molar = P / (ciddor_z(T, P, x) * T)
    return molar * ((1 - x) * dry * 288.15 * za / 101325.0 + x * wet * 293.15 * zw / 1333.0)


# ---- the medium inside one cell ------------------------------------------------------------------------
# cell columns: 0 left, 1 right, 2..5 cubic T in (h-left), 6 lapse, 7 geopotential base, 8..11 cubic rh,
#               12 ln P left; 13.. Chebyshev of ln P - ln P left

@njit(cache=True)
def temperature(h, c, inversions, layers):
    d = h - c[0]
    T = c[2] + d * (c[3] + d * (c[4] + d * c[5]))
    if c[6] != 0.0:
        T = T + c[6] * (R0_GEOPOTENTIAL * h / (R0_GEOPOTENTIAL + h) - c[7])
    for k in range(inversions.shape[0]):
        x = (h - inversions[k, 1]) / inversions[k, 2]
        if x.real > 0:
            e = np.exp(-x)
            T = T - inversions[k, 0] * e / (1 + e)
        else:
            T = T - inversions[k, 0] / (1 + np.exp(x))
    for k in range(layers.shape[0]):
        T = T + layers[k, 0] * np.exp(-h / layers[k, 1])
    return T


@njit(cache=True)
def humidity(h, c):
    d = h - c[0]
    return c[8] + d * (c[9] + d * (c[10] + d * c[11]))


@njit(cache=True)
def ln_pressure_slope(h, T, rh, P, virtual):
    """d ln P/dh.  virtual: moist air weighs less by (1 - 0.378 x)."""
    g = (R0_GEOPOTENTIAL / (R0_GEOPOTENTIAL + h)) ** 2
    s = -K_HYDROSTATIC * g / T
    if virtual and rh.real != 0.0:
        s = s * (1 - (1 - 18.015 / 28.9635) * ciddor_mole_fraction(T, P, rh))
    return s


@njit(cache=True)
def refractivity(T, P, rh, model, dry, wet):
    if model == 3:
        return ciddor_refractivity(T, P, ciddor_mole_fraction(T, P, rh), dry, wet, 450.0)
    t_ref = 288.15 if model == 2 else 273.15
    return dry * (P / 101325.0) * (t_ref / T)


@njit(cache=True)
def ln_pressure_table(h, c):
    u = (2 * h - c[0] - c[1]) / (c[1] - c[0])
    b1 = 0.0 * u
    b2 = 0.0 * u
    for k in range(CHEB, 0, -1):
        b1, b2 = c[13 + k] + 2 * u * b1 - b2, b1
    return c[12] + c[13] + u * b1 - b2


@njit(cache=True)
def medium(h, ln_p, c, inversions, layers, model, dry, wet, exaggerate, virtual):
    """(n-1, d(n-1)/dh, d ln P/dh, density) at real h, given ln P there."""
    hc = complex(h, STEP)
    if model == 4:                                       # refractivity itself is the cubic
        d = hc - c[0]
        N = dry * (c[2] + d * c[3]) * exaggerate
        return N.real, N.imag / STEP, 0.0, 1.0
    T = temperature(hc, c, inversions, layers)
    rh = humidity(hc, c)
    slope = ln_pressure_slope(h, T.real, rh.real, math.exp(ln_p), virtual)
    P = math.exp(ln_p) * complex(1.0, slope * STEP)
    N = refractivity(T, P, rh, model, dry, wet) * exaggerate
    return N.real, N.imag / STEP, slope, P.real * 28.9644 / (8314.32 * T.real)


@njit(cache=True)
def refractivity_at(h, c, inversions, layers, model, dry, wet, exaggerate, virtual):
    ln_p = 0.0 if model == 4 else ln_pressure_table(h, c)
    N, dN, _, rho = medium(h, ln_p, c, inversions, layers, model, dry, wet, exaggerate, virtual)
    return N, dN, rho


# ---- a profile file -------------------------------------------------------------------------------------

def fritsch_carlson(x, y):
    """Slopes of the monotone cubic (PCHIP: Fritsch & Butland weighted harmonic mean, three-point ends)."""
    h = np.diff(x)
    d = np.diff(y) / h
    n = len(x)
    m = np.zeros(n)
    if n == 2:
        return np.array([d[0], d[0]])
    for k in range(1, n - 1):
        if d[k - 1] * d[k] > 0:
            w1, w2 = 2 * h[k] + h[k - 1], h[k] + 2 * h[k - 1]
            m[k] = (w1 + w2) / (w1 / d[k - 1] + w2 / d[k])
    for e, (h0, h1, d0, d1) in {0: (h[0], h[1], d[0], d[1]), n - 1: (h[-1], h[-2], d[-1], d[-2])}.items():
        s = ((2 * h0 + h1) * d0 - h0 * d1) / (h0 + h1)
        if s * d0 <= 0:
            s = 0.0
        elif d0 * d1 <= 0 and abs(s) > 3 * abs(d0):
            s = 3 * d0
        m[e] = s
    return m


class Profile:
    """A profile in the contract's TOML, or `us76`.  `virtual` picks the humid hydrostatic rule."""
    _serials = itertools.count()

    def __init__(self, source="us76", virtual=False, **override):
        spec = {} if source == "us76" else tomllib.loads(Path(source).read_text())
        spec.update(override)
        self.name = "us76" if source == "us76" else Path(source).stem
        if spec.get("smooth_m", 0):
            raise ValueError("smooth_m is out of the oracle's scope")
        self.serial = next(Profile._serials)          # key of the caches elsewhere
        self.earth_radius = spec.get("earth_radius_m", 6371000.0)
        self.p0 = spec.get("surface_pressure_Pa", 101325.0)
        self.exaggerate = spec.get("exaggerate", 1.0)
        self.index = spec.get("index", "born-wolf")
        self.virtual = virtual
        self.inversions = np.array([[i["delta_T_K"], i["height_m"], i["diffuseness_m"]]
                                    for i in spec.get("inversion", [])], float).reshape(-1, 3)
        self.layers = np.array([[i["delta_T_K"], i["scale_m"]] for i in spec.get("surface_layer", [])],
                               float).reshape(-1, 2)
        self.index_levels = sorted((r["height_m"], r["refractivity"]) for r in spec.get("index_level", []))
        rows = sorted(spec.get("level", []), key=lambda r: r["height_m"])
        self.levels = [(r["height_m"], r["temperature_K"], r.get("relative_humidity", 0.0)) for r in rows]
        self.cubic = spec.get("interpolation", "linear") == "cubic"
        self.model = MODELS["index_level" if self.index_levels else self.index]
        self._build()

    def lam(self, nm):
        """(model, dry, wet) for one wavelength."""
        dry, wet = dispersion(self.index, nm)
        if self.model == 4:
            return 4, dry / dispersion(self.index, 550.0)[0], 0.0
        return self.model, dry, wet

    def args(self, nm):
        return (self.cells, self.inversions, self.layers, *self.lam(nm), self.exaggerate, self.virtual)

    # -- cells --
    def _knots(self):
        """Heights where some derivative jumps."""
        if self.model == 4:
            return {0.0, TOP_M} | {h for h, _ in self.index_levels}
        k = {0.0, TOP_M} | {h for h, _, _ in self.levels}
        last = self.levels[-1][0] if self.levels else -1.0
        return k | {geometric(H) for H in US76_BASES[1:] if geometric(H) > last}

    def _edges(self):
        """Knots, plus cells small enough for every feature to be resolved."""
        e = set(self._knots())
        for _, h, a in self.inversions:
            e |= {h + s * a * m for s in (-1, 1) for m in (0, 1, 2, 4, 7, 11, 16, 24, 40, 80)}
        for _, s in self.layers:
            e |= {s * m for m in (1, 2, 4, 7, 11, 16, 24, 40, 80)}
        e |= {1.0, 10.0, 100.0, 500.0}
        e = sorted(h for h in e if 0 <= h <= TOP_M)
        e = [a for i, a in enumerate(e) if i == 0 or a - e[i - 1] > 1e-9]
        out = []
        for a, b in zip(e, e[1:]):
            n = max(1, math.ceil((b - a) / 1500.0))
            out += [a + (b - a) * i / n for i in range(n)]
        return out + [e[-1]]

    def _fill(self, c, mid):
        """Coefficients of T (or n-1) and humidity in the cell that holds mid."""
        if self.model == 4:
            hs = np.array([h for h, _ in self.index_levels])
            vs = np.array([v for _, v in self.index_levels])
            i = int(np.clip(np.searchsorted(hs, mid) - 1, 0, len(hs) - 2))
            slope = (vs[i + 1] - vs[i]) / (hs[i + 1] - hs[i])
            if mid < hs[0] or mid > hs[-1]:
                c[2] = vs[0] if mid < hs[0] else vs[-1]
            else:
                c[2], c[3] = vs[i] + slope * (c[0] - hs[i]), slope
            return
        offset = 0.0
        if self.levels:
            hs, ts, rs = (np.array(v, float) for v in zip(*self.levels))
            if mid < hs[0]:
                c[2], c[8] = ts[0], rs[0]
                return
            if mid < hs[-1]:
                i = int(np.searchsorted(hs, mid) - 1)
                for y, at in ((ts, 2), (rs, 8)):
                    c[at:at + 4] = self._segment(hs, y, i, c[0])
                return
            offset = ts[-1] - us76_temperature(hs[-1])
        H = R0_GEOPOTENTIAL * mid / (R0_GEOPOTENTIAL + mid)
        i = max(k for k in range(8) if US76_BASES[k] <= H)
        c[2], c[6], c[7] = US76_T[i] + offset, US76_LAPSES[i], US76_BASES[i]

    def _segment(self, x, y, i, left):
        """Cubic of interval i, re-centred on `left`."""
        h, d = x[i + 1] - x[i], (y[i + 1] - y[i]) / (x[i + 1] - x[i])
        p = [y[i], d, 0.0, 0.0]
        if self.cubic:
            m = fritsch_carlson(x, y)
            p = [y[i], m[i], (3 * d - 2 * m[i] - m[i + 1]) / h, (m[i] + m[i + 1] - 2 * d) / h**2]
        q = np.polynomial.polynomial.Polynomial(p)(np.polynomial.polynomial.Polynomial([left - x[i], 1.0]))
        out = np.zeros(4)
        out[:len(q.coef)] = q.coef
        return out

    def _build(self):
        e = self._edges()
        self.cells = np.zeros((len(e) - 1, 13 + CHEB + 1))
        ln_p = math.log(self.p0)
        for c, a, b in zip(self.cells, e, e[1:]):
            c[0], c[1] = a, b
            self._fill(c, 0.5 * (a + b))
            c[12] = ln_p
            if self.model != 4:
                ln_p = self._pressure(c)
        self.edges = np.array(e)

    def _pressure(self, c):
        """Chebyshev series of ln P in the cell; returns ln P at its top."""
        u = np.cos(np.pi * (np.arange(CHEB) + 0.5) / CHEB)
        h = 0.5 * (c[0] + c[1]) + 0.5 * (c[1] - c[0]) * u
        lp = np.full(CHEB, c[12])
        for _ in range(8 if self.virtual else 1):          # Picard: the vapour share depends on P
            s = [ln_pressure_slope(x, temperature(complex(x), c, self.inversions, self.layers).real,
                                   float(humidity(x, c)), math.exp(p), self.virtual) for x, p in zip(h, lp)]
            f = np.polynomial.chebyshev.chebfit(u, np.array(s), CHEB - 1)
            g = np.polynomial.chebyshev.chebint(f, lbnd=-1) * 0.5 * (c[1] - c[0])
            lp = c[12] + np.polynomial.chebyshev.chebval(u, g)
        c[13:13 + CHEB + 1] = g
        return c[12] + np.polynomial.chebyshev.chebval(1.0, g)

    def cell_of(self, h):
        return int(np.clip(np.searchsorted(self.edges, h, side="right") - 1, 0, len(self.cells) - 1))

    def state(self, h, nm):
        """T, P, density, n-1, d(n-1)/dh at h (in the cell above, on an edge)."""
        c = self.cells[self.cell_of(h)]
        N, dN, rho = refractivity_at(h, c, *self.args(nm)[1:])
        P = math.exp(ln_pressure_table(h, c))
        T = temperature(complex(h), c, self.inversions, self.layers).real
        return T, P, rho, N, dN
