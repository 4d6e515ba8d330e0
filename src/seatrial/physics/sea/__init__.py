"""Sea models: waves, the loads of waves, current and wind as functions of time and place."""
