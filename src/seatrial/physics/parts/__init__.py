"""Parts of a body, each of which meets the water where it is: propulsors, foils, ballast."""
