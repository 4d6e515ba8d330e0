"""Many copies of one system in compiled code."""
