"""The part of a frame that MoveNet is shown."""

import numpy as np
import pytest

from data import crops

SIZE = (400, 600)
SHOULDERS, HIPS, LEFT_ANKLE = [5, 6], [11, 12], 15


@pytest.fixture
def person() -> np.ndarray:
    """Keypoints [17,3] of someone upright, his hips at 200, 300; all seen."""
    keypoints = np.array([[200.0, 300, 0.9]] * 17)
    keypoints[SHOULDERS, 1] -= 50
    keypoints[LEFT_ANKLE, 1] += 100
    return keypoints


@pytest.mark.parametrize(
    ("size", "square"),
    [(SIZE, (-100, 0, 600)), ((600, 400), (0, -100, 600)), ((50, 50), (0, 0, 50))],
)
def test_a_whole_image_is_padded_on_both_sides(size, square):
    assert crops.whole(size) == crops.Square(*square)


def test_the_person_is_in_the_middle_and_has_room(person):
    assert crops.around(person, SIZE) == crops.Square(80, 180, 240)  # 1.2 times the ankle's 100
    person[LEFT_ANKLE, 2] = 0.1
    assert crops.around(person, SIZE) == crops.Square(105, 205, 190)  # 1.9 times the trunk's 50


@pytest.mark.parametrize("joints", [SHOULDERS, HIPS])
def test_without_a_trunk_the_whole_image_is_shown(person, joints):
    person[joints[0], 2] = 0.1
    assert crops.around(person, SIZE) != crops.whole(SIZE)
    person[joints[1], 2] = 0.1
    assert crops.around(person, SIZE) == crops.whole(SIZE)


def test_no_square_is_larger_than_the_image(person):
    person[LEFT_ANKLE, 1] = 590
    assert crops.around(person, SIZE) == crops.whole(SIZE)
    person[HIPS, 0] = 0  # then the far side limits it
    person[SHOULDERS, 0] = 0
    assert crops.around(person, (580, 600)) == crops.whole((580, 600))


def test_shares_of_the_square_are_pixels_of_the_image():
    square = crops.Square(-100, 20, 200)
    found = np.array([[[0.0, 0.5, 0.9], [1.0, 0.25, 0.1]]])  # y, x, score
    np.testing.assert_allclose(square.to_image(found), [[[0, 20, 0.9], [-50, 220, 0.1]]])


def test_pixels_of_the_square_are_those_of_the_image():
    """The outer corners of the corner pixels are the square's."""
    square = crops.Square(-100, 20, 200)
    corners = np.array([[-0.5, -0.5, 1], [49.5, 49.5, 1]])
    np.testing.assert_allclose(corners @ square.to_pixels(50).T, [[-100.5, 19.5], [99.5, 219.5]])
