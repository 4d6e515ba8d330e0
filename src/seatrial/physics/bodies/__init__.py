"""Bodies of simple shape: mass, inertia and added mass from main dimensions."""
