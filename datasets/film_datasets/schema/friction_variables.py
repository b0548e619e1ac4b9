"""The variables of friction: results of an oblique impact and, of a single one, its motion and events."""

from __future__ import annotations

from film_datasets.schema.motion_variables import number, spaced
from film_datasets.schema.variable import BYTE, IMPACTS, Variable
from film_model.oblique.result import KINDS, MOTION, OBLIQUE, REGIMES

REGIME, ERROR, LOW, HIGH = "sliding_regime", "estimated_friction_error", "sliding_after_low", "sliding_after_high"
_ABSENT = "NaN if nothing slides"


def _results(dims: tuple[str, ...]) -> tuple[Variable, ...]:
    words = tuple(enumerate(word.replace(" ", "_") for word in REGIMES))
    return (
        *(
            number(name, dims, dimension, spaced(name), f"{what}; {_ABSENT}", True)
            for name, (dimension, what) in OBLIQUE.items()
        ),
        Variable(REGIME, dims, BYTE, None, "how the contact slides", flags=((-1, "none"), *words)),
        Variable(
            *(ERROR, dims, number("", (), "dimensionless", "").dtype, "1", "estimated error of the sliding velocity"),
            comment="after the impact, over the sliding velocity before; NaN if nothing slides",
            optional=True,
        ),
    )


IN_SWEEPS = _results((IMPACTS,))

_ALONG = {
    "sliding_velocity": ("velocity", "of the contacting point relative to the target"),
    "tangential_velocity": ("velocity", "of the impactor's centre along the surface"),
    "spin": ("angular_frequency", "positive if it adds to sliding"),
    "friction_force": ("force", "on the impactor, against sliding at first touch"),
}

IN_STEPS = tuple(number(name, ("t",), dimension, spaced(name), what) for name, (dimension, what) in _ALONG.items())
"""The motion along the surface of a component that was run in steps."""

IN_HISTORIES = (
    *_results(()),
    *(
        number(name, (), "velocity", f"{which} sliding velocity after the impact", "of two models beyond yield", True)
        for name, which in ((LOW, "lower"), (HIGH, "higher"))
    ),
    *(
        number(
            *("friction_time" if name == "time" else name, ("friction_time",), dimension),
            "time of the friction" if name == "time" else spaced(name),
            what,
            optional=name == "stick_radius",
        )
        for name, (dimension, what) in MOTION.items()
    ),
    number("friction_event_time", ("friction_event",), "time", "time at which a phase of the friction begins"),
    Variable(
        "friction_event_kind", ("friction_event",), BYTE, None, "phase of the friction", flags=tuple(enumerate(KINDS))
    ),
)
