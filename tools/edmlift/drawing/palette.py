"""The colours of every picture: Okabe and Ito's, told apart with any colour vision, and in grey."""

import math

SIDES = {"right": "#D55E00", "left": "#0072B2", "trunk": "#3B3F46"}
SIDE_NAMES = {"right": "subject's right", "left": "subject's left", "trunk": "trunk"}
TRUTH = "#6E747C"
TEXT, FAINT = "#24292F", "#6E747C"
WHITE, PAPER, SHADOW, SKIN = "#FFFFFF", "#F1F3F5", "#D6DAE0", "#DDE1E6"
CAMERA = "#8A9099"


_APART = 11  # of 255: colours that are nearer look the same, and Pillow confuses them
FADE = 0.4  # of white in what is farthest from the viewer


def rgb(colour: str) -> tuple[int, int, int]:
    """Red, green and blue of "#RRGGBB"."""
    red, green, blue = bytes.fromhex(colour[1:])
    return red, green, blue


def mix(colour: str, other: str, amount: float) -> str:
    """A colour, and so much of another one in it, 0 to 1."""
    pairs = zip(rgb(colour), rgb(other), strict=True)
    return "#" + "".join(f"{round(a + (b - a) * amount):02X}" for a, b in pairs)


def flat_palette() -> list[int]:
    """Red, green and blue of the colours of a picture without a photo: the above, faded as they
    may be, and what lies between them and their background at a smooth edge."""
    faded = [mix(side, WHITE, FADE * n / 6) for side in SIDES.values() for n in range(7)]
    solid = [*faded, TEXT, FAINT, CAMERA, SHADOW, SKIN, PAPER]
    edges = [mix(colour, WHITE, n / 4) for colour in solid for n in (1, 2, 3)]
    dark = [mix(colour, back, 0.5) for colour in faded[::3] for back in (PAPER, SKIN, SHADOW)]
    chosen: list[tuple[int, int, int]] = []
    for colour in map(rgb, [WHITE, *solid, *edges, *dark]):
        if all(math.dist(colour, other) > _APART for other in chosen):
            chosen.append(colour)
    return [value for colour in chosen for value in colour]
