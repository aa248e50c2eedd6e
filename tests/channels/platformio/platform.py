"""A PlatformIO platform whose boards are emulated cores."""

from platformio.public import PlatformBase


class EmulatedPlatform(PlatformBase):
    """It needs no package: the compilers are on the path."""
