"""The rows of the league: results/program/league.csv, one line for a planner's motion of a program under limits."""
import csv

TEXTS = ("program", "planner", "failed")
COLUMNS = ["program", "acceleration", "jerk", "planner", "time_s", "error_um", "point_um", "path_um", "end_um",
           "velocity_pct", "acceleration_pct", "jerk_pct", "any_bound_s", "legs_bound_s", "failed"]
EXCESSES = ("point_um", "path_um", "end_um", "velocity_pct", "acceleration_pct", "jerk_pct")  # empty if none
PLACES = {"time_s": 3, "any_bound_s": 3, "legs_bound_s": 3}  # the others have one


def key(row):
    return row["program"], row["acceleration"], row["jerk"], row["planner"]


def read(path):
    """Of a file that an earlier run wrote; none if there is none. Numbers that are not known are None, excesses that are none are 0."""
    if not path.exists():
        return []
    rows = []
    with open(path, newline="") as file:
        for row in csv.DictReader(file):
            for name in COLUMNS:
                if name not in TEXTS:
                    row[name] = float(row[name]) if row[name] else 0.0 if name in EXCESSES else None
            row["acceleration"], row["jerk"] = int(row["acceleration"]), int(row["jerk"])
            rows.append(row)
    return rows


def write(path, rows):
    """Whole or not at all."""
    part = path.with_suffix(".part")
    with open(part, "w", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(COLUMNS)
        for row in rows:
            line = []
            for name in COLUMNS:
                value = row.get(name)
                if value is None or (name in EXCESSES and value <= 0.05):
                    line.append("")
                elif isinstance(value, float):
                    line.append("%.*f" % (PLACES.get(name, 1), value))
                else:
                    line.append(value)
            writer.writerow(line)
    part.replace(path)
