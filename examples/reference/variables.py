"""The pages docs/reference/{fmu_variables,dataset_variables}.md, from the tables of variables."""

from examples.reference.markdown import MADE, table, unit
from film_datasets.schema import ATTRIBUTES, CONSTANTS, TABLE, TEXT, VERSIONS, Variable
from film_datasets.schema.derivative_variables import SIDES
from fmu_wrapper.variables import EVENT_KINDS, KINDS, PHASES, VARIABLES


def fmu_page() -> str:
    """The variables of an FMU."""
    rows = (
        (
            f"`{v.name}`",
            *(v.causality.get(kind, "–") for kind in KINDS),
            unit(v.dimension) if v.dimension else f"{'whole number' if v.type == 'Whole' else v.type}",
            v.description,
            _range(v.low, v.high),
        )
        for v in VARIABLES
    )
    phases = ((f"`{name}`", str(code), what) for code, (name, what) in enumerate(PHASES.items()))
    events = ((f"`{name}`", str(code), what) for code, (name, what) in enumerate(EVENT_KINDS.items()))
    return f"""# FMU variables

{MADE}The same names in FMI 2.0 and 3.0, by `--kind`; – if there is none. A parameter exists if the scene's law or
target has it. Values are SI, directions positive into the target. Sensors have outputs such as
`sensor_tip_acceleration`.

{table(("variable", *KINDS, "unit", "meaning", "range"), rows)}
## Phases

{table(("`phase`", "code", "meaning"), phases)}
## Events

{table(("`last_event`", "code", "meaning"), events)}"""


def _range(low: float | None, high: float | None) -> str:
    if low is None or high is None:
        return "" if low is None else f"at least {low:g}"
    return f"{low:g} to {high:g}"


def dataset_page() -> str:
    """The variables and attributes of datasets."""
    kinds = "\n".join(
        f"## {name}\n\n{table(('variable', 'dimensions', 'unit', 'meaning'), map(_row, variables))}"
        for name, variables in {**TABLE, "scalars of histories and sweeps, where known": CONSTANTS}.items()
    )
    attributes = table(
        ("kind", "version", "attributes"),
        ((f"`{kind}`", VERSIONS[kind], ", ".join(f"`{name}`" for name in names)) for kind, names in ATTRIBUTES.items()),
    )
    return f"""# Dataset variables

{MADE}Datasets follow CF-1.11, in SI units; the attribute `film_model_schema` names their kind. The dimension
`impacts` of a sweep stands for the swept quantities of a grid, or for `impact`. Sweeps may also have:

{
        table(
            ("with", "attribute that names them", "variables"),
            [
                ("derivatives", "`derivatives`", "`d_<value>_d_<number>` for every summary value"),
                ("", "", "`derivative_accuracy_<number>`: largest estimated relative error"),
                ("", "", f"`derivative_side_<number>`: {', '.join(f'{k} `{word}`' for k, word in SIDES)}"),
                ("sensors", "`sensors`", "`sensor_<name>_maximum_displacement`, `…_velocity`, `…_acceleration`"),
                ("strain", "", "`sensor_<name>_maximum_strain_x`, `…_strain_y`, `…_bending_stress`"),
                ("not all values", "`variables`", ""),
            ],
        )
    }
## Global attributes

{attributes}
## Variables

{kinds}"""


def _row(variable: Variable) -> tuple[str, ...]:
    what = ": ".join(filter(None, (variable.long_name, variable.comment)))
    unit = (
        "text"
        if variable.dtype == TEXT
        else "flag"
        if variable.unit is None
        else ""
        if variable.unit == "1"
        else f"`{variable.unit}`"
    )
    return f"`{variable.name}`", ", ".join(f"`{dim}`" for dim in variable.dims), unit, what
