"""`python -m film_model`: the command line."""

import sys

from film_model.cli import main

sys.exit(main())
