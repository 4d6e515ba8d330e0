"""Landing of a multirotor on a moving deck: tracking, prediction, control."""
