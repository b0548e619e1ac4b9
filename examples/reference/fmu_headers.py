"""The C headers that are generated: `python -m examples.reference.fmu_headers` writes them."""

from __future__ import annotations

import textwrap

from film_model.base.errors import STATUSES
from film_model.base.units import scene_unit
from fmu_wrapper import platforms
from fmu_wrapper.variables import CHANGES, KINDS, RIGID, VARIABLES, Real, Variable, Whole, reference, settable

_ROLES = {"independent": "OUTPUT", "parameter": "PARAMETER", "input": "INPUT", "output": "OUTPUT", "local": "OUTPUT"}
_TYPES = {Real: "REAL", Whole: "WHOLE"}


def headers() -> dict[str, str]:
    """Text of each generated header, by file name."""
    return {"variables.h": _variables(), "failures.h": _failures()}


def write() -> None:
    """Write the headers into the runtime's folder."""
    for name, text in headers().items():
        (platforms.ROOT / platforms.RUNTIME / name).write_text(text, encoding="utf-8")


def _variables() -> str:
    """The table of FMU variables."""
    rows = [
        "/* The variables, by value reference. Generated from fmu_wrapper/variables.csv; do not edit. */",
        "#ifndef FILM_VARIABLES_H",
        "#define FILM_VARIABLES_H",
        "",
        "enum {",
        textwrap.indent(textwrap.fill(", ".join(v.name.upper() for v in VARIABLES) + ", VARIABLES,", 116), "    "),
        f"    SETTABLE = {settable()} /* parameters and inputs come before this one */",
        "};",
        "",
        "enum { IMPACT, CONTACT, KINDS };",
        "enum { ABSENT, PARAMETER, INPUT, OUTPUT };",
        "enum { REAL, WHOLE, ENUMERATION };",
        f"enum {{ {', '.join(map(str.upper, CHANGES))} }}; /* when a real one changes: CHANGES in variables.py */",
        "",
        f"static const double RIGID = {RIGID!r}; /* N s/m: a target with this impedance or more does not move */",
        "",
        "/* by: the inputs and states that it depends on directly, and those if the law is damped: sums of BY. */",
        "#define BY(reference) (1u << ((reference) - EXTERNAL_FORCE))",
        "typedef struct {",
        "    const char *name, *unit;",
        "    int type, changes, tunable, role[KINDS];",
        "    double low, high;",
        "    unsigned by[KINDS], by_if_damped[KINDS];",
        "} film_variable;",
        "",
        "static const film_variable VARIABLE[VARIABLES] = {",
        *map(_variable, VARIABLES),
        "};",
        "",
        "#endif",
        "",
    ]
    return "\n".join(rows)


def _variable(v: Variable) -> str:
    roles = ", ".join(_ROLES[v.causality[kind]] if kind in v.causality else "ABSENT" for kind in KINDS)
    checked = v in VARIABLES[: settable()]  # the runtime checks what an importer sets, not its own outputs
    low = repr(float(v.low)) if checked and v.low is not None else "-1e300"
    high = repr(float(v.high)) if checked and v.high is not None else "1e300"
    unit = "" if v.dimension is None else scene_unit(v.dimension)
    what = f"{_TYPES.get(v.type, 'ENUMERATION')}, {v.changes.upper()}, {int(v.variability == 'tunable')}"
    by = ", ".join(f"{{{', '.join(_sum(of.get(kind, ())) for kind in KINDS)}}}" for of in (v.depends, v.depends_damped))
    return f'    {{"{v.name}", "{unit}", {what}, {{{roles}}}, {low}, {high}, {by}}},'


def _sum(names: tuple[str, ...]) -> str:
    """The sum of BY of some variables."""
    return f"{sum(1 << (reference(name) - reference('external_force')) for name in names):#x}"


def _failures() -> str:
    """The sentence of each failure that the core reports."""
    failed = {code: status for code, status in sorted(STATUSES.items(), reverse=True) if -100 < code < 0}
    rows = [
        "/* A sentence for each failure of the core. Generated from film_model/base/errors.py; do not edit. */",
        "#ifndef FILM_FAILURES_H",
        "#define FILM_FAILURES_H",
        "",
        "static inline const char *film_failure(int status) {",
        "    switch (status) {",
        *(f'    case {code}: return "{status.sentence}";' for code, status in failed.items()),
        '    default: return "unknown status";',
        "    }",
        "}",
        "",
        "#endif",
        "",
    ]
    return "\n".join(rows)


if __name__ == "__main__":
    write()
