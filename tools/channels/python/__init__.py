"""The source distribution and the wheels."""
