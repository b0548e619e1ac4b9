"""Which effects a scene calls for, each with the number that decided; `film_model.effects.choose.choose` decides."""

from __future__ import annotations

from film_model.effects.choose import Choice, problem_of
from film_model.effects.effect import COMPUTED, Effect
from film_model.effects.judged import RULES
from film_model.effects.many import problems_of, rows_of
from film_model.effects.target_motion import Support

__all__ = ["COMPUTED", "RULES", "Choice", "Effect", "Support", "problem_of", "problems_of", "rows_of"]
