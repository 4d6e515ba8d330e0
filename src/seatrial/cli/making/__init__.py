"""Commands that write files: vehicles, sketches, packages."""
