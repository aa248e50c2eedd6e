"""How the library gets to people: a module a channel, and the release that has all of them.

A channel is a module, in the folder of those that are alike, with

    build(folder) -> list[Path]     writes what a release has of it: the same bytes each time
    check(files) -> None            optional: installs these files and tries them
"""
