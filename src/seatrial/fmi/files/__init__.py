"""Files of FMUs: archives, model descriptions, terminals, variables."""
