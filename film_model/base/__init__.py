"""Used by all other packages: units, errors, fields of scene objects, materials, files, helpers for arrays."""
