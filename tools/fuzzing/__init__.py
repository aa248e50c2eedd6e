"""Fuzzing: what is fuzzed, runs of the fuzzers in tests/fuzz, and their figures."""
