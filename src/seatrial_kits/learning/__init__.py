"""Tasks for agents that learn, and trained networks as components."""
