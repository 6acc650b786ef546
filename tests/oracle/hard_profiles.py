"""The airs of the hard cases, drawn by a seeded generator so that none is chosen to suit the solver.

Writes tests/data/reference/hard/profiles/NAME.toml and returns what to ask of each: {group: [(name, [eye heights])]}.
`width` of an inversion is where it changes from 10 % to 90 %: 2 ln 9 = 4.394 times its diffuseness.
"""
import math
import random
from pathlib import Path

SEED = 20041123
HARD = Path(__file__).resolve().parent.parent / "data" / "reference" / "hard"


def table(name, row):
    return f"[[{name}]]\n" + "".join(f"{k} = {v:.9g}\n" for k, v in row.items())


def inversion(delta, height, width):
    return {"delta_T_K": delta, "height_m": height, "diffuseness_m": width / 4.394449}


def log_uniform(rng, a, b):
    return math.exp(rng.uniform(math.log(a), math.log(b)))


def save(name, what, tables=(), levels=(), extra=""):
    text = f"# {what}\n{extra}" + "".join(table(n, r) for n, r in tables)
    if levels:
        text += "level = [\n" + "".join(f"  {{ height_m = {h:.9g}, temperature_K = {t:.9g} }},\n" for h, t in levels) + "]\n"
    (HARD / "profiles").mkdir(parents=True, exist_ok=True)
    (HARD / "profiles" / f"{name}.toml").write_text(text)
    return name


def around(i):
    """Eyes below, in and above a layer."""
    h, a = i["height_m"], i["diffuseness_m"]
    return [round(max(0.3, h - 6 * a - 2), 3), round(h + 0.4 * a, 6), round(h + 6 * a + 2, 3)]


def thin_inversions(rng):
    out = []
    corners = [(30.0, 0.1), (0.1, 0.1), (30.0, 50.0), (-30.0, 0.3)]
    drawn = [(rng.choice((1, 1, 1, -1)) * log_uniform(rng, 0.1, 30), log_uniform(rng, 0.1, 50)) for _ in range(8)]
    for k, (delta, width) in enumerate(corners + drawn):
        i = inversion(round(delta, 4), round(width * 1.5 + rng.uniform(3, 150), 3), round(width, 5))
        eyes = around(i)
        out.append((save(f"thin{k}", f"{delta:.3g} K within {width:.3g} m", [("inversion", i)]), rng.sample(eyes, 2)))
    return out


def surface_layers(rng):
    out = []
    for k, (delta, scale, eye) in enumerate([(20.0, 0.02, 1.5)] + [
            (rng.uniform(10, 25), log_uniform(rng, 0.01, 0.1), 1.5) for _ in range(2)]):
        row = {"delta_T_K": round(delta, 4), "scale_m": round(scale, 5)}
        out.append((save(f"road{k}", f"hot road: {delta:.3g} K within {scale:.3g} m", [("surface_layer", row)]), [eye]))
    for k in range(3):
        row = {"delta_T_K": round(rng.uniform(2, 7), 4), "scale_m": round(log_uniform(rng, 0.2, 2), 4)}
        out.append((save(f"sea{k}", "warm sea", [("surface_layer", row)]), [round(rng.uniform(2, 25), 2)]))
    cold = {"delta_T_K": -round(rng.uniform(4, 9), 3), "scale_m": round(rng.uniform(3, 9), 3)}
    out.append((save("ice", "cold surface: a duct on the ground", [("surface_layer", cold)]), [0.0, 1.7, 40.0]))
    return out


def ducts(rng):
    out = []
    for k in range(4):
        i = inversion(round(rng.uniform(4, 15), 3), round(rng.uniform(40, 150), 2), round(rng.uniform(4, 30), 2))
        out.append((save(f"duct{k}", "a duct", [("inversion", i)]), around(i)))
    low = [(0.0, 271.0), (30.0, 271.2), (55.0, 279.3), (400.0, 278.0), (2000.0, 266.0)]
    out.append((save("duct_levels", "a duct between linear levels", levels=low), [12.0, 47.0, 70.0]))
    out.append((save("duct_cubic", "the same levels, cubic", levels=low, extra='interpolation = "cubic"\n'), [12.0, 47.0]))
    return out


def stacked(rng):
    out = []
    for k in range(2):
        h = round(rng.uniform(8, 60), 2)
        pair = [inversion(round(log_uniform(rng, 0.5, 8), 3), h + d, round(log_uniform(rng, 0.2, 4), 3)) for d in (0, 5)]
        out.append((save(f"pair{k}", "two inversions 5 m apart", [("inversion", i) for i in pair]),
                    [round(max(0.5, h - rng.uniform(2, 8)), 2), h + 2.5, h + 12]))
    for k in range(1):
        ten = [inversion(round(rng.choice((1, 1, -1)) * log_uniform(rng, 0.1, 3), 3), round(rng.uniform(3, 300), 2),
                         round(log_uniform(rng, 0.1, 8), 3)) for _ in range(10)]
        out.append((save(f"ten{k}", "ten thin inversions", [("inversion", i) for i in ten]),
                    [2.0, round(rng.uniform(20, 280), 2)]))
    return out


def levels(rng):
    out = []
    for k, step in enumerate((0.06, 0.35)):
        t, rows = 285.0, []
        for h in range(121):
            rows.append((float(h), round(t, 3)))
            t += rng.gauss(-0.01, step)
        rows += [(1500.0, round(t - 9, 2))]
        out.append((save(f"kinks{k}", f"a kink every metre, steps of {step} K", levels=rows), [1.5, 60.0, 60.37]))
    for k, (gap, jump) in enumerate(((0.01, 5.0), (0.003, -4.0), (0.0005, 9.0), (0.008, 0.7))):
        h = round(rng.uniform(6, 90), 2)
        t = 284.0 - 0.0065 * h
        rows = [(0.0, 284.0), (h, t), (h + gap, t + jump), (h + 500, t + jump - 3)]
        eyes = [round(h * rng.uniform(0.2, 0.8), 2), h + 0.5 * gap, h + rng.uniform(3, 20)]
        out.append((save(f"jump{k}", f"{jump} K within {gap * 1000:g} mm", levels=rows), [round(e, 5) for e in eyes]))
    return out


def horizon(rng):
    eyes = [0.0, 0.01, 2.0, 3000.0, 10000.0] + [round(10 ** rng.uniform(0, 4), 2) for _ in range(4)]
    return [("us76", eyes)]


def above_air(rng):
    eyes = [120000.0, 119999.0, 120500.0, 408000.0, 9000000.0, round(rng.uniform(121e3, 800e3), 1)]
    return [("us76", eyes), ("duct1", [408000.0]), ("ten0", [150000.0])]


GROUPS = {f.__name__: f for f in (thin_inversions, surface_layers, ducts, stacked, levels, horizon, above_air)}


def draw():
    """Every group from a generator of its own, so that a group can grow without changing the others."""
    drawn = {name: f(random.Random(f"{SEED} {name}")) for name, f in GROUPS.items()}
    return {g: [(n, [round(h, 6) for h in eyes]) for n, eyes in airs] for g, airs in drawn.items()}
