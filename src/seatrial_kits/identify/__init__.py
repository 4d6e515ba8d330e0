"""Parameters of a vehicle's axes from logs of commands and sensors."""
