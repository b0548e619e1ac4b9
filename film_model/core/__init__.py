"""The compiled core: the only solver there is (C99), and its Python face `native`."""
