# A sweep under Snakemake: snakemake -s scripts/sweep.snakefile --cores 4 --config points=points.jsonl
# One rule a point; argil itself decides whether a point is done and resumes one that was stopped. A mark says only that it was
# asked since the points were written.
from pathlib import Path

POINTS = Path(config["points"])
FOLDER = POINTS.with_suffix("")
COUNT = len(POINTS.read_text().splitlines())

rule table:
    input: expand(f"{FOLDER}/{{index}}.ran", index=[f"{i:06d}" for i in range(COUNT)])
    output: f"{FOLDER}.csv"
    shell: f"argil sweep collect {POINTS} -o {FOLDER}"

rule point:
    input: POINTS
    output: touch(f"{FOLDER}/{{index}}.ran")
    params: index=lambda wildcards: int(wildcards.index)
    shell: f"argil sweep run {POINTS} --index {{params.index}}"
