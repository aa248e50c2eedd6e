"""tests/vectors/vectors.h is what make_vectors.py makes of the networks in gen/ today."""

import re
import sys
from pathlib import Path

import numpy as np
import pytest

ROOT = Path(__file__).resolve().parents[2]
FOLDER = ROOT / "tests" / "vectors"
GEN = ROOT / "gen"
sys.path.insert(0, str(FOLDER))

import make_vectors  # noqa: E402

NUMBER = re.compile(r"(?<![\w.])-?\d+(?:\.\d+)?(?:e[+-]?\d+)?(?!\w)")


@pytest.fixture(scope="module")
def made() -> str:
    for name in make_vectors.MODELS:
        if not (GEN / f"{name}.npz").exists():
            pytest.skip(f"gen/{name}.npz is not there yet")
    return make_vectors.vectors(GEN)


@pytest.mark.slow
def test_the_vectors_are_up_to_date(made: str) -> None:
    """Numbers, not bytes: eigenvectors of another LAPACK differ in the last digits."""
    kept = (FOLDER / "vectors.h").read_text("utf-8")
    assert NUMBER.sub("#", kept) == NUMBER.sub("#", made), "run tests/vectors/make_vectors.py"
    kept_numbers, made_numbers = (
        np.array([float(text) for text in NUMBER.findall(text)]) for text in (kept, made)
    )
    # Next to zero a number is what is left of larger ones: a tenth of a micrometre.
    np.testing.assert_allclose(made_numbers, kept_numbers, rtol=1e-6, atol=1e-7)


@pytest.mark.long
def test_making_them_twice_gives_the_same_bytes(made: str) -> None:
    assert made == make_vectors.vectors(GEN)
