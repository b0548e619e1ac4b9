"""Scene, documentation and reference results of an FMU, in a manifest of the layered standard FMI-LS-REF."""

from __future__ import annotations

import csv
import io

import numpy as np

from film_model.base.arrays import Array
from film_model.solve.component import ImpactComponent
from film_model.solve.history import MOTION
from fmu_wrapper.model_description import Experiment

FOLDER = "extra/org.fmi-standard.fmi-ls-ref"

RESULTS = "reference_results.csv"
"""Motion at the communication points of the default experiment, from the library, in SI units."""


def related_files(component: ImpactComponent | None, experiment: Experiment) -> dict[str, bytes]:
    """The manifest and, for an impact, reference results. component: at its beginning, as the FMU is exported."""
    related = [
        ("application/toml", "../../resources/scene.toml", "model", "Scene from which film-model made the FMU"),
        ("text/html", "../../documentation/index.html", "document", "Variables, assumptions and results of the FMU"),
    ]
    files: dict[str, bytes] = {}
    if component is not None:
        stop, step = experiment.stop_time, experiment.step_size
        text = f"Results of film-model at the communication points of the default experiment, in steps of {step:g} s"
        related.append(("text/csv", RESULTS, "result", text))
        files[f"{FOLDER}/{RESULTS}"] = _results(component, stop, step)
    rows = "".join(
        f'  <Related type="{kind}" source="{source}" role="{role}" description="{description}"/>\n'
        for kind, source, role, description in related
    )
    manifest = (
        '<?xml version="1.0" encoding="UTF-8"?>\n'
        '<fmiReferences xmlns:fmi-ls="http://fmi-standard.org/fmi-ls-manifest"\n'
        '               fmi-ls:fmi-ls-name="org.fmi-standard.fmi-ls-ref"\n'
        '               fmi-ls:fmi-ls-version="1.0.0-beta.1"\n'  # the standard's own example says 1.0.0-alpha.1
        '               fmi-ls:fmi-ls-description="Layered Standard providing information on related files included '
        'in an FMU.">\n'
        f"{rows}</fmiReferences>\n"
    )
    return {f"{FOLDER}/fmi-ls-manifest.xml": manifest.encode(), **files}


def reference_results(text: str) -> dict[str, Array]:
    """Columns of reference results by name. Raises ValueError if a column is missing or a value is not a number."""
    names = ["time", *MOTION]
    head, _, rows = text.partition("\n")
    if head != ",".join(names):
        raise ValueError(f"{RESULTS}: the columns are not {', '.join(names)}")
    try:
        values = np.loadtxt(io.StringIO(rows), delimiter=",", ndmin=2).reshape(-1, len(names))
    except ValueError as error:
        raise ValueError(f"{RESULTS}: {error}") from None
    return dict(zip(names, values.T, strict=True))


def _results(component: ImpactComponent, stop: float, step: float) -> bytes:
    text = io.StringIO()
    table = csv.writer(text, lineterminator="\n")
    table.writerow(["time", *MOTION])
    for k in range(round(stop / step) + 1):
        time = min(k * step, stop)
        outputs = component.step(time - component.time).outputs
        table.writerow([repr(time), *(repr(getattr(outputs, name)) for name in MOTION)])
    return text.getvalue().encode()
