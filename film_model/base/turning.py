"""Spin and moment of inertia of a ball, as fields of the impactor and of a free body."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, ClassVar

from film_model.base.errors import Mistake
from film_model.base.fields import Field, choice, measure, mistake

SHAPES = {"solid": 0.4, "shell": 2.0 / 3.0}
"""Bodies → J/(m R²)."""

TURNING: Mapping[str, Field] = {
    "spin": measure("angular_frequency", -1e7, 1e7),
    "shape": Field(choice(*SHAPES).read, '"solid" or "shell" is needed'),
    "inertia": measure("moment_of_inertia", 1e-60, 1e30),
}


def contradictions(ball: Any) -> list[Mistake]:
    """A mistake if the moment of inertia is not that of the given shape."""
    if ball.inertia is None or ball.shape is None or ball.own_mass is None:
        return []
    own = SHAPES[ball.shape] * ball.own_mass * ball.radius**2
    if abs(ball.inertia - own) <= 0.01 * own:
        return []
    what = f'{ball.inertia:.4g} kg m^2 contradicts shape = "{ball.shape}", which has {own:.4g} kg m^2'
    return [mistake(ball, "inertia", f"{what}: leave one of them out")]


class Turning:
    """A ball that may spin."""

    is_ball: ClassVar[bool] = True

    @property
    def inertia_number(self: Any) -> float:
        """J/(m R²): of the given moment of inertia, otherwise 2/5 of a solid ball and 2/3 of a thin shell."""
        if self.inertia is not None:
            return self.inertia / (self.own_mass * self.radius**2)
        return SHAPES[self.shape or "solid"]

    @property
    def diameter(self: Any) -> float:
        """Twice the radius, m."""
        return 2.0 * self.radius
