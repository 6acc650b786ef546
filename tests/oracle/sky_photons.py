"""Rayleigh's air over a flat Earth by photons: what reaches the ground and what leaves, for all orders of scattering.

Nothing here is shared with greenray.  One slab that only scatters (scalar Rayleigh, no depolarisation), a Lambertian
ground, a Sun of irradiance 1; photons are followed one by one, each order with the full phase function.

    python3 tests/oracle/sky_photons.py > tests/data/reference/sky_photons.csv
"""
import numpy as np

rng = np.random.default_rng(6)
COUNT = 4_000_000


def scattered(direction):
    """New directions by the phase function 3/4 (1 + c^2): c by Cardano's formula."""
    u = 2 * rng.random(len(direction)) - 1
    a = np.cbrt(2 * u + np.sqrt(4 * u * u + 1))
    c = a - 1 / a
    s, phi = np.sqrt(np.clip(1 - c * c, 0, None)), 2 * np.pi * rng.random(len(direction))
    z = direction
    x = np.where(np.abs(z[:, :1]) < 0.9, np.array([[1.0, 0, 0]]), np.array([[0, 1.0, 0]]))
    x = np.cross(x, z)
    x /= np.linalg.norm(x, axis=1, keepdims=True)
    y = np.cross(z, x)
    d = (s * np.cos(phi))[:, None] * x + (s * np.sin(phi))[:, None] * y + c[:, None] * z
    return d / np.linalg.norm(d, axis=1, keepdims=True)


def case(depth, mu0, albedo):
    """Diffuse irradiance on the ground, flux that leaves upward, and radiance of the zenith, for irradiance 1 across
    the Sun's rays."""
    d = np.tile([np.sqrt(1 - mu0 * mu0), 0, -mu0], (COUNT, 1))
    tau = np.zeros(COUNT)                      # from the top
    weight = mu0 / COUNT
    ground = up = zenith = 0.0
    first = True
    while len(d):
        step = -np.log(rng.random(len(d)))
        tau = tau - step * d[:, 2]
        gone, down = tau < 0, tau > depth
        up += weight * gone.sum()
        ground += 0 if first else weight * down.sum()
        first = False
        reflected = down & (rng.random(len(d)) < albedo)
        inside = ~gone & ~down
        # towards an eye on the ground that looks up: next event
        c = d[inside, 2]
        zenith += weight * (3 / (16 * np.pi) * (1 + c * c) * np.exp(-(depth - tau[inside]))).sum()
        new = scattered(d[inside])
        m = np.sqrt(rng.random(reflected.sum()))
        phi = 2 * np.pi * rng.random(reflected.sum())
        s = np.sqrt(1 - m * m)
        bounced = np.stack([s * np.cos(phi), s * np.sin(phi), m], axis=1)
        d = np.concatenate([new, bounced])
        tau = np.concatenate([tau[inside], np.full(reflected.sum(), depth)])
    return ground, up, zenith


print("# irradiance 1 across the Sun's rays; scalar Rayleigh, flat: tests/oracle/sky_photons.py, %d photons" % COUNT)
print("depth,sine_of_sun_altitude,albedo,diffuse_irradiance,flux_up,zenith_radiance")
for depth, mu0, albedo in [(0.1, 0.8, 0.0), (0.1, 0.3, 0.0), (0.35, 0.8, 0.0), (0.35, 0.5, 0.0), (0.35, 0.2, 0.0), (0.35, 0.5, 0.5),
                           (0.35, 0.5, 1.0), (1.0, 0.6, 0.2)]:
    print(",".join(f"{x:g}" for x in (depth, mu0, albedo)) + "," + ",".join(f"{x:.5f}" for x in case(depth, mu0, albedo)),
          flush=True)
