"""`python -m film_model`: the command line."""

import sys

from film_model.cli.main import main

sys.exit(main())
