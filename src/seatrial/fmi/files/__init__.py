"""What FMU files say: archives, model descriptions, terminals, variables."""
