"""Writes section/target_sights.csv: python section_targets.py. Where rays through air that varies pass a distance.

Route 1 of section.py (double integration: T, P over every x, then the ray by DOP853): the height above the surface at
which the ray of each apparent altitude passes a distance; blank where it met the ground before. Air and eyes of
novaya-zemlya (a duct that rises and weakens) and of profiles/moving.toml (an inversion that falls below the eye).
"""
from section import ROOT, TABLES, Air, trace

CASES = [  # profile, eye m, distance m, altitudes from, to, step deg
    ("novaya-zemlya", 10.0, 40000.0, -0.30, 0.30, 0.02),
    ("novaya-zemlya", 10.0, 120000.0, -0.30, 0.30, 0.02),
    ("falling_layer", 20.0, 15000.0, -0.25, 0.35, 0.01),
    ("falling_layer", 20.0, 30000.0, -0.25, 0.35, 0.01),
]
NM = 550.0


def main():
    rows = []
    for name, eye, distance, low, high, step in CASES:
        shipped = ROOT / f"profiles/{name}.toml"
        air = Air(shipped if shipped.exists() else TABLES / f"profiles/{name}.toml")
        for i in range(round((high - low) / step) + 1):
            deg = low + i * step
            row = trace(air, eye, deg, NM, until_m=distance)
            passed = f"{row['height_m']:.6f}" if row["status"] == "in-flight" else ""
            rows.append(f"{name},{eye:g},{NM:g},{distance:g},{deg:.4f},{passed}")
        print(name, distance, flush=True)
    head = ["# Made by tests/oracle/section_targets.py (section.py, route 1): height above the surface at which a ray",
            "# passes a distance; blank where it met the ground before.",
            "profile,height_m,wavelength_nm,distance_m,apparent_altitude_deg,height_at_distance_m"]
    (TABLES / "target_sights.csv").write_text("\n".join(head + rows) + "\n")


if __name__ == "__main__":
    main()
