"""Mutation testing of lib/: would the C tests see a small fault?"""
