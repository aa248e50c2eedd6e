"""The page that lifts what a camera, a video or a dragged skeleton shows, in the browser.

Its scripts are in this folder; those that `edmlift view` has as well are in tools/edmlift/viewing.
`tools/web` builds and serves it (docs/browser.md).
"""
