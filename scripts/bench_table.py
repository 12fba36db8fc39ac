#!/usr/bin/python3
"""Google Benchmark's JSON on standard input → a table (CSV) with a column for every counter of any row. Of a benchmark's
repetitions that of the least time stays."""
import csv
import json
import sys

OMITTED = {"family_index", "per_family_instance_index", "run_name", "run_type", "repetitions", "repetition_index", "threads"}

least = {}
for row in json.load(sys.stdin)["benchmarks"]:
    if row["run_type"] != "iteration":
        continue
    name = row["name"] = row["name"].split("/repeats:")[0]
    if name not in least or row["real_time"] < least[name]["real_time"]:
        least[name] = row
rows = sorted(least.values(), key=lambda row: (row["family_index"], row["per_family_instance_index"]))
first = ["name", "iterations", "real_time", "cpu_time", "time_unit"]
others = sorted({key for row in rows for key in row} - OMITTED - set(first))
table = csv.DictWriter(sys.stdout, first + others, extrasaction="ignore", restval="", lineterminator="\n")
table.writeheader()
for row in rows:
    table.writerow({key: f"{value:.6g}" if isinstance(value, float) else value for key, value in row.items()})
