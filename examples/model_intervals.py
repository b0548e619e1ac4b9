"""Write film_model/problem/model_intervals.json: `python -m examples.model_intervals [FILE]`.

The residuals of the measured rows that are not held out, under law "auto" with rate hardening and without; run it when
that law or the rows change, and then `python -m examples.validation_page`.
"""

import json
import sys
from pathlib import Path

import film_datasets as fd
from examples.measured_residuals import predictions, residuals, slow_predictions
from film_datasets.evidence import evidence_rows
from film_model.problem.law_of_scene import ELASTIC, YIELDING
from film_model.problem.model_intervals import STORED


def main(path: Path = Path(STORED)) -> Path:
    """Write the file; returns its path."""
    measured = evidence_rows(fd.load("measured_impacts"))
    found = residuals([*predictions(measured), *slow_predictions(measured)])
    rows = ",\n".join(f"    {json.dumps(one._asdict())}" for one in found)
    laws = json.dumps([ELASTIC, YIELDING])
    text = f'{{\n  "made_by": "examples/model_intervals.py",\n  "laws": {laws},\n  "residuals": [\n{rows}\n  ]\n}}\n'
    path.write_text(text, encoding="utf-8")
    return path


if __name__ == "__main__":
    print(main(*map(Path, sys.argv[1:])))
