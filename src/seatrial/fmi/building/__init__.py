"""Components as FMUs."""
