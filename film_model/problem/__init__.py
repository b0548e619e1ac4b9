"""A scene without units: the dimensionless numbers and the curve for the core, and the way back to a summary in SI."""
