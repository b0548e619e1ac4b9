"""Results: one impact (`film_model.solve.simulate.simulate`), a component in steps, many impacts; error estimates."""
