"""Ships: hulls that rudders or thrusters steer, their engines and autopilots."""
