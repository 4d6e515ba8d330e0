"""Standard sea trials: manoeuvres as trials, their figures, criteria of the IMO."""
