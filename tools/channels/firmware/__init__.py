"""Packages of what microcontrollers are programmed with: Arduino, PlatformIO, ESP-IDF, Zephyr."""
