"""The library as one file: which sources, what is inlined, and the channel of it."""
