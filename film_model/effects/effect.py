"""One effect on an impact: its indicator, the threshold, and whether it is simulated."""

from __future__ import annotations

from typing import Any, NamedTuple

SIMULATED, NOT_NEEDED, SWITCHED_OFF = "simulated", "not needed", "switched off"
NOT_MODELLED, NOT_JUDGED = "needed but not modelled", "not judged"

FREE = "none"
"""Cost of an effect that takes no additional segments."""

ABSENT = "not supported"
"""Cost of an effect that this package cannot simulate."""

DAMPED, PUSHED = "each 3.5 × the time", "each 2 × the time"
"""Time per segment with target motion, and with a load, over that without; measured by `benchmarks/effects.py`."""

SPRUNG = "each 5 × the time"
"""The same for a contact in series with a spring."""

ON_MODES = "motion of the modes, about 100 times slower"
"""7 to 160 times against infinite plates: a steel ball on steel plates of 2 and 4 mm, 115 to 1068 modes."""

STRETCHED = "motion of the modes, about 1000 times slower"
"""3 to 20 times against the modes of a square plate without membrane forces, with 11 and 15 that have them."""

COMPUTED = {
    "plasticity": 'the contact yields: for law "auto", elastoplastic instead of hertz',
    "rate_hardening": "the yield strength rises with the strain rate of the impact",
    "viscoelasticity": "the modulus of a material with a prony series relaxes during the contact",
    "material_damping": 'losses of materials with a loss factor: for law "auto", tsuji instead of hertz',
    "small_slope": 'surfaces of soft balls are steep: for law "auto", large-slope instead of hertz or tsuji',
    "fully_plastic": "the contact reaches the last stage of a law that yields",
    "target_motion": "the target moves, by its impedance, its static stiffness or its vibrations",
    "wave_losses": 'waves in a half-space carry energy away: simulated for law "auto"',
    "boundary_reflections": "waves return from the edges of a plate or beam before contact ends",
    "target_inertia": "a plate or beam with edges vibrates; its static stiffness alone does not describe it",
    "stretching": "membrane forces stiffen a plate or beam that is bent: needs in_plane in [target]",
    "gravity": "the impactor's weight presses on the contact",
}
"""Effects that can be simulated, and their meaning, in the order of lists. The estimated ones follow."""


class Effect(NamedTuple):
    """One effect: its indicator, the threshold, and whether it is simulated.

    value: of the indicator. threshold: value of the indicator from which the effect matters; None if there is none.
    change: largest relative change of the summary if the effect is neglected, None if unknown. state: "simulated",
    "not needed", "switched off" (by the scene, and it does not matter), "needed but not modelled" or "not judged" (the
    scene lacks an entry; `reason` says which). source: of indicator and change. cost: of simulating the effect.
    """

    name: str
    indicator: str
    value: float | None
    threshold: float | None
    change: float | None
    state: str
    reason: str
    source: str
    cost: str = FREE

    def __repr__(self) -> str:
        return f"Effect({self.line})"

    @property
    def simulated(self) -> bool:
        """Whether the simulation includes the effect."""
        return self.state == SIMULATED

    @property
    def warning(self) -> str | None:
        """The warning if the effect matters and is not simulated, otherwise None."""
        if self.state != NOT_MODELLED:
            return None
        size = "by an unknown amount" if self.change is None else f"by about {percent(self.change)}"
        return f"not modelled: {self.name.replace('_', ' ')}, which would change the summary {size}; {self.reason}"

    @property
    def line(self) -> str:
        """As in "gravity: not needed, m g/F_m = 0.00115 (threshold 0.00667), error if neglected 0.18 %; …"."""
        value = "" if self.value is None else f", {self.indicator} = {self.value:.4g}"
        limit = "" if self.threshold is None else f" (threshold {self.threshold:.4g})"
        change = "" if self.change is None else f", error if neglected {percent(self.change)}"
        return f"{self.name}: {self.state}{value}{limit}{change}; {self.reason}"

    def to_dict(self) -> dict[str, Any]:
        """Plain values, for JSON."""
        return self._asdict()


def off_state(size: float | None, tolerance: float) -> str:
    """The state of an effect that the scene switches off: needed if it is larger than the tolerance, or unknown."""
    return NOT_MODELLED if size is None or size > tolerance else SWITCHED_OFF


def percent(change: float) -> str:
    """0.0123 → "1.2 %"."""
    return f"{100 * change:.2g} %" if change < 0.995 else "100 % or more"
