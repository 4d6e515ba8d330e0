"""Values of vehicles' files: quantities with units, expressions, and references to each other."""
