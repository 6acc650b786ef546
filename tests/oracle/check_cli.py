"""Runs `greenray refraction` (and `trace`) over the reference tables and prints the largest errors.  Standard library only.

python check_cli.py --greenray PATH [--precision float double] [--trace] [--profile NAME] [TABLE.csv ...]
TABLE defaults to refraction_standard.csv and refraction_inversions.csv (with --trace: trace_terrestrial.csv).
--profile names the profile of tables without a profile column (the supplied h_obs_m,...,lambda_nm tables).
One process per (profile, height, precision).  Errors are divided by max(1, |dRda|); exit status 1 when an error passes
--tolerance (arcsec; default 0.02 float, 1e-4 double) or a status differs.
"""
import argparse
import csv
import subprocess
import sys
from collections import defaultdict
from pathlib import Path

DATA = Path(__file__).resolve().parent.parent / "data" / "reference"


def rows_of(text):
    return list(csv.DictReader(line for line in text.splitlines() if line and not line.startswith("#")))


def load(path, profile):
    rows = rows_of(Path(path).read_text())
    for r in rows:
        r["profile"] = r.get("profile") or profile or "us76"
        r["height_m"] = r.get("height_m") or r.get("h_obs_m")
        r["wavelength_nm"] = r.get("wavelength_nm") or r.get("lambda_nm")
        r["min_height_m"] = r.get("min_height_m") or r.get("h_min_m")
    return rows


def profile_argument(name):
    file = DATA / "profiles" / f"{name}.toml"
    return str(file) if file.exists() else name


def unique(values):
    """Distinct texts, largest number first (so that a list does not begin with a minus sign if it can be helped)."""
    return sorted(set(values), key=float, reverse=True)


def run(greenray, command, name, height, rows, precision, surface, extra):
    """{(altitude, wavelength[, distance]): answer row} of one process; keys are the texts asked for."""
    altitudes = unique(r["apparent_altitude_deg"] for r in rows)
    wavelengths = unique(r["wavelength_nm"] for r in rows)
    distances = unique(r["distance_m"] for r in rows)[::-1] if surface else [None]
    args = [greenray, command, profile_argument(name), "--height", height, "--altitudes", ",".join(altitudes),
            "--wavelengths", ",".join(wavelengths), "--precision", precision]
    if surface:
        args += ["--distances", ",".join(distances), "--surface", surface]
    done = subprocess.run(args + extra, capture_output=True, text=True)
    if done.returncode:
        print(f"  {name} h={height}: exit {done.returncode}: {done.stderr.strip()[-300:]}")
        return {}
    got = rows_of(done.stdout)
    keys = [(a, w, d) for a in altitudes for w in wavelengths for d in distances]
    if len(got) != len(keys):
        print(f"  {name} h={height}: {len(got)} rows, {len(keys)} asked for")
        return {}
    for key, row in zip(keys, got):
        if abs(float(row["apparent_altitude_deg"]) - float(key[0])) > 1e-6 or \
           abs(float(row["wavelength_nm"]) - float(key[1])) > 1e-3:
            print(f"  {name} h={height}: rows are not in the order asked for, at {key}")
            return {}
    return dict(zip(keys, got))


FIELDS = {"refraction": (("refraction_arcsec", "refraction_arcsec"), ("air_mass", "air_mass"),
                         ("min_height_m", "min_height_m"), ("ground_distance_m", "ground_distance_m")),
          "trace": (("end_height_m", "height_m"), ("bending_arcsec", "bending_arcsec"),
                    ("elevation_deg", "elevation_deg"), ("optical_path_m", "optical_path_m"))}


class Tally:
    def __init__(self):
        self.rows = self.missing = self.wrong_status = self.wrong_turns = 0
        self.worst = {}
        self.examples = []

    def add(self, command, want, got):
        self.rows += 1
        if got is None:
            self.missing += 1
            return
        where = ",".join(str(want.get(k)) for k in ("height_m", "apparent_altitude_deg", "wavelength_nm", "distance_m") if want.get(k))
        if got["status"] != want["status"]:
            self.wrong_status += 1
            self.examples.append(f"{where}: {want['status']} but got {got['status']}")
            return
        if want.get("turning_points") and got.get("turning_points") not in (None, "", want["turning_points"]):
            self.wrong_turns += 1
        slope = abs(float(want.get("dRda") or 0.0))
        for key, theirs in FIELDS[command]:
            if not want.get(key) or not got.get(theirs):
                continue
            w, g = float(want[key]), float(got[theirs])
            error = abs(g - w) / (max(1.0, slope) if key == "refraction_arcsec" else 1.0)
            if key in ("air_mass", "ground_distance_m"):
                error /= max(1.0, abs(w)) * max(1.0, slope)
            label = key if command == "trace" else f"{want['status']}:{key}"
            if error >= self.worst.get(label, (-1.0, ""))[0]:
                self.worst[label] = (error, where)


def main():
    ap = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    ap.add_argument("--greenray", required=True)
    ap.add_argument("--precision", nargs="+", default=["float", "double"])
    ap.add_argument("--trace", action="store_true")
    ap.add_argument("--profile")
    ap.add_argument("--only", nargs="+", help="only these profiles")
    ap.add_argument("--tolerance", type=float)
    ap.add_argument("--extra", default="", help="more flags for greenray, one string")
    ap.add_argument("tables", nargs="*")
    a = ap.parse_args()
    command = "trace" if a.trace else "refraction"
    tables = a.tables or [DATA / t for t in (("trace_terrestrial.csv",) if a.trace else
                                             ("refraction_standard.csv", "refraction_inversions.csv"))]
    bad = False
    for table in tables:
        groups = defaultdict(list)
        for r in load(table, a.profile):
            if not a.only or r["profile"] in a.only:
                groups[r["profile"], r["height_m"], r.get("surface")].append(r)
        for precision in a.precision:
            print(f"{Path(table).name}  {command}  {precision}")
            limit = a.tolerance or {"float": 0.02, "double": 1e-4}[precision]
            tallies = defaultdict(Tally)
            for (name, height, surface), rows in groups.items():
                got = run(a.greenray, command, name, height, rows, precision, surface, a.extra.split())
                for r in rows:
                    key = (r["apparent_altitude_deg"], r["wavelength_nm"], r.get("distance_m") if surface else None)
                    tallies[name].add(command, r, got.get(key))
            for name, t in tallies.items():
                worst = "  ".join(f"{k} {v:.2e} @{w}" for k, (v, w) in sorted(t.worst.items()))
                print(f"  {name}: {t.rows} rows, {t.missing} missing, {t.wrong_status} status, {t.wrong_turns} turns;  {worst}")
                for e in t.examples[:5]:
                    print(f"      {e}")
                over = [v for k, (v, _) in t.worst.items() if k in ("space:refraction_arcsec", "ground:refraction_arcsec") and v > limit]
                bad |= bool(over or t.missing or t.wrong_status)
    sys.exit(1 if bad else 0)


if __name__ == "__main__":
    main()
