"""The pages docs/reference/{sweep_file,csv_files,command_line}.md: what is written in files and on the command line."""

import argparse
from collections.abc import Mapping

from examples.reference.markdown import MADE, table, unit, words
from film_datasets.csv_measurement import CONVERTED, NAMES
from film_datasets.schema import MEASURED_MOTION
from film_datasets.sweeps.axis_reading import SPACINGS
from film_datasets.sweeps.designs import DESIGNS, MOST_SAMPLES
from film_datasets.sweeps.distributions import DISTRIBUTIONS, EMPIRICAL
from film_model.cli.main import GROUPS, parser
from film_model.solve.history import SUMMARY

COMMANDS = {
    "new": "film-model new --kind plate --output scene.toml",
    "run": "film-model run scene.toml --accuracy 1e-8 --output impact.nc --plot impact.png",
    "bounce": "film-model bounce scene.toml --plot bounces.png",
    "cost": "film-model cost scene.toml --plot cost.png",
    "hard-cases": 'film-model hard-cases --match "turns at"',
    "reference-impacts": "film-model reference-impacts --output impacts --workers 2",
    "score": "film-model score results --plot score.png",
    "validate": "film-model validate --law all --plot errors.png",
    "explore": "film-model explore scene.toml",
    "export-page": "film-model export-page scene.toml --output impact.html",
    "export-fmu": "film-model export-fmu scene.toml --fmi 3 --output impact.fmu",
    "export-ssp": "film-model export-ssp scene.toml --output impact.ssp",
    "check-fmu": "film-model check-fmu impact.fmu",
    "contact-for": "film-model contact-for mujoco scene.toml --velocity 0.1..2",
    "spectrum": "film-model spectrum scene.toml --plot spectrum.png",
    "modes": "film-model modes read bracket.unv --node 1201 --direction z --sensors 17,44 --output bracket.csv",
    "sweep": "film-model sweep sweep.toml --output sweep.nc",
    "plot": "film-model plot sweep.nc --quantity maximum_force",
    "check": "film-model check sweep.nc",
    "convert": "film-model convert sweep.nc sweep.csv",
    "summarise": "film-model summarise sweep.nc --quantity maximum_force",
    "tolerance": "film-model tolerance sweep.toml --quantity maximum_force --plot tornado.png",
    "table": 'film-model table scene.toml --from "0.01 m/s" --to "10 m/s" --output restitution.csv',
    "identify": "film-model identify measured.csv scene.toml --fit contact.yield_strength",
    "explain": "film-model explain scene.toml --law all",
    "laws": "film-model laws --plot laws.png",
    "cite": "film-model cite scene.toml > models.bib",
    "materials": "film-model materials --search glass",
}
"""An example of each command."""


def sweep_page() -> str:
    """The keys of a sweep file."""
    samples = ", ".join(f"{most:,} for `{design}`" for design, most in MOST_SAMPLES.items())
    spread = [
        (f"`{{ {name} = [{', '.join('abcd'[: len(one.roles)])}] }}`", one.what) for name, one in DISTRIBUTIONS.items()
    ]
    return f"""# Sweep file

{MADE}`film-model sweep sweep.toml --output sweep.nc` runs it.

{
        table(
            ("key", "meaning", "value", "default"),
            [
                ("`scene`", "scene file, in the same folder", "a path", "required"),
                (
                    "`design`",
                    "how the impacts are placed",
                    f'{words(DESIGNS)} or `{{ file = "runs.csv" }}`',
                    '`"grid"`',
                ),
                ("`samples`", f"number of impacts; at most {samples}", "a whole number", "required if sampled"),
                ("`seed`", "of the random numbers", "a whole number from 0", "`1`"),
                ("`correlation`", "of the swept quantities", "a matrix, by rows", "none"),
                ("`derivatives`", "of the summary, by keys of the scene", '`["impactor.velocity", …]`', "none"),
                ("`variables`", "the summary values that are kept", '`["maximum_force", …]`', "all"),
                ("`[over]`", "the swept keys of the scene, `section.key` in quotes", "see below", "required"),
            ],
        )
    }
{
        table(
            ("design", "impacts"),
            [
                ('`"grid"`', "every value with every other"),
                ('`"zip"`', "first values together, then second values, and so on"),
                ('`"random"`, `"sobol"`, `"latin-hypercube"`', "`samples` points; Sobol's cover ranges most evenly"),
                ('`{ file = "runs.csv" }`, or `.parquet`', "[rows of your table](../sweeps.md), without `[over]`"),
            ],
        )
    }
## `[over]`

{
        table(
            ("value of a key that is a number", "meaning"),
            [
                ('`["1 m/s", "2 m/s"]`', "a list; in a grid it increases or decreases"),
                (
                    '`{ from = "1 m/s", to = "9 m/s", count = 50, spacing = "log" }`',
                    f"spacing {words(SPACINGS)}; no `count` in sampled designs",
                ),
                *spread,
                (f'`{{ {EMPIRICAL} = ["1 m/s", "1.2 m/s", …] }}`', "observed values, interpolated linearly"),
                ('`"10 mm ± 0.05 mm"`, `"10 mm ± 0.5 %"`', "uniform between the limits"),
            ],
        )
    }
Distributions need a sampled design. Words take lists: `"contact.law" = ["hertz", "stronge"]`; whole sections too:
`"contact" = [{{ law = "hertz" }}, {{ law = "tsuji", restitution = 0.7 }}]`.

## Example

```toml
scene = "scene.toml"
design = "sobol"
samples = 4096
seed = 1

[over]
"impactor.velocity" = {{ from = "1 m/s", to = "10 m/s", spacing = "log" }}
"target.material.yield_strength" = {{ normal = ["250 MPa", "10 MPa"] }}
```
"""


def csv_page() -> str:
    """The CSV files that are read."""
    short: dict[str, list[str]] = {}
    for word, name in NAMES.items():
        short.setdefault(name, []).append(word)
    converted = table(
        ("column", "stored as", "unit, e.g.", "meaning"),
        ((f"`{word}`", f"`{one.variable}`", unit(one.dimension), one.what) for word, one in CONVERTED.items()),
    )

    def rows(quantities: Mapping[str, tuple[str, str]]) -> str:
        return table(
            ("column", "short names", "unit, e.g.", "meaning"),
            (
                (f"`{name}`", ", ".join(f"`{word}`" for word in short.get(name, ())), unit(dimension), what)
                for name, (dimension, what) in quantities.items()
            ),
        )

    return f"""# CSV files

{MADE}UTF-8 text of at most 100 MB. The first line names the columns with their units, `time [us], force [kN]`; in
measurements the units may be a row of their own. Commas, semicolons or tabs separate, `#` begins a comment.
Restitutions may be in `[%]`.

Other headings, as of an oscilloscope, are named by `film-model identify … --columns time=TIME force="CH1 [2.2 kN]"`,
with the unit unless the file has it; a factor is that of the sensor, here 2.2 kN/V. Other columns are ignored.

## A measured history

For `film-model identify` and `film_datasets.from_csv`; times from first touch.

{rows({"t": ("time", "time since first touch; required"), **MEASURED_MOTION})}
```text
time [us], force [N]
0, 0
10, 61
20, 188
```

## Measured motions of sensors

For `film-model identify --force-from` and `film_datasets.identify_force`: even times, and for each sensor its
displacement, velocity or acceleration, by the unit.

```text
time [us], corner [m/s^2], wall [g]
0, 0.3, 0.01
5, 0.1, -0.02
```

## Measured impacts

For `film-model identify`, one row for each impact. Only velocities are required.

{rows({"impactor_velocity": ("velocity", "at first touch, normal to the surface; required"), **SUMMARY})}
```text
velocity [m/s], restitution
0.2, 0.61
0.5, 0.50
```

## Columns that are converted

{converted}
Accelerations may be in `g`, 9.80665 m/s². Heights are those of falls without drag.

```text
drop_height, rebound_height
mm, mm
100, 31
500, 112
```

## A contact law as a table

`law = "tabulated"` with `file = "…"` in `[contact]`:

```text
indentation [um], force [N]
0, 0
5, 180
10, 520
```

## Vibrations of a structure

`kind = "structure"` with `file = "…"` in `[target]`, one row for each vibration. Decimal commas between semicolons and
Fortran's exponents `1.5D+03` are read. A comment may give the static compliance: `# static_compliance = 4.01e-6 m/N`.

{
        table(
            ("column", "unit, e.g.", "meaning"),
            [
                ("`frequency`", "`Hz`", "0: a motion of the whole structure; required"),
                ("`modal_mass`", "`kg`", "of the shape in the next column"),
                ("`shape`", "", "deflection of that shape at the struck point, along the impact"),
                ("`shape_…`", "", "deflection at a sensor that names this column; optional"),
                ("`strain_…`", "`1/m`", "strain at a sensor that names this column, of the same shape; optional"),
                ("`mass_normalised_shape`", "`1/sqrt(kg)`", "replaces both: the shape whose modal mass is 1"),
                ("`damping_ratio`", "", "optional"),
            ],
        )
    }
```text
frequency [Hz], modal_mass [kg], shape
182, 0.91, 1
417, 1.40, 0.6
```
"""


def command_page() -> str:
    """Every command with its options and an example."""
    commands = next(action for action in parser()._actions if isinstance(action, argparse._SubParsersAction)).choices
    sections = "\n".join(
        f"## {name}\n\n{commands[name].description}\n\n```sh\n{COMMANDS[name]}\n```\n\n{_options(commands[name])}"
        for names in GROUPS.values()
        for name in names
    )
    return f"""# Command line

{MADE}Progress and warnings go to standard error. `--json` prints one JSON object, in SI units.

| exit status | |
| --- | --- |
| 0 | done |
| 2 | the scene, the FMU or the command line is wrong |
| 3 | the work failed, a file cannot be read or written, or a check failed |
| 130 | interrupted |

{sections}"""


def _options(command: argparse.ArgumentParser) -> str:
    rows: list[tuple[str, str, str]] = []
    for action in command._actions:
        if isinstance(action, argparse._HelpAction):
            continue
        value = action.metavar or ("" if action.choices or action.nargs == 0 else action.dest.upper())
        words = " or ".join(f"`{choice}`" for choice in action.choices or ())
        name = " ".join((*action.option_strings[:1], str(value))).strip() if action.option_strings else action.dest
        rows.append((f"`{name}`", words, (action.help or "").replace("%%", "%")))
    return table(("argument", "choices", "meaning"), rows)
