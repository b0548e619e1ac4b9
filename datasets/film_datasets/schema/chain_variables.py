"""Variables of the motion of a chain of bodies."""

from __future__ import annotations

from film_datasets.schema.motion_variables import number, spaced
from film_datasets.schema.variable import INTEGER, TEXT, Variable
from film_model.solve.chain_motion import BODIES, CONTACTS

ABSENT = "NaN if it does not happen"

CHAINS = (
    number("t", ("t",), "time", "time since the start"),
    Variable("body", ("body",), INTEGER, "1", "number of the body", "in the order in which they lie"),
    Variable("contact", ("contact",), INTEGER, "1", "number of the contact", "those with the target are the last"),
    Variable("contact_front", ("contact",), INTEGER, "1", "number of the body in front"),
    Variable("contact_behind", ("contact",), INTEGER, "1", "number of the body behind", "0: the target"),
    *(number(name, ("body",), dimension, spaced(name), what) for name, (dimension, what) in BODIES.items()),
    *(
        number(name, ("contact",), dimension, spaced(name), f"{what}; {ABSENT}", optional=True)
        for name, (dimension, what) in CONTACTS.items()
    ),
    Variable("contact_law", ("contact",), TEXT, None, "contact law"),
    Variable("contact_count", ("contact",), INTEGER, "1", "how often contact began"),
    *(
        number(name, (along, "t"), dimension, spaced(name), what)
        for along, name, dimension, what in (
            ("body", "displacement", "length", "since the start"),
            ("body", "velocity", "velocity", ""),
            ("contact", "indentation", "length", "negative: a gap"),
            ("contact", "contact_force", "force", "that presses the bodies apart"),
        )
    ),
)
