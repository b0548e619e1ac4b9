"""Which effects a scene calls for, each with the number that decided; `film_model.effects.choose.choose` decides."""
