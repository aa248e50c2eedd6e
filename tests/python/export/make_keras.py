"""Writes files by Keras itself into a folder, and what its models compute: test_keras.py runs it in
a process of its own, because Keras has settings for a whole process.

    make_keras.py FOLDER
"""

import os
import sys
from pathlib import Path

os.environ["KERAS_BACKEND"] = "jax"
os.environ["KERAS_HOME"] = sys.argv[1]

import keras  # noqa: E402
import numpy as np  # noqa: E402
from keras import layers  # noqa: E402

ENDS = (".keras", ".h5", ".weights.h5")


def functional() -> keras.Model:
    inputs = keras.Input((7, 13))
    x = layers.Flatten()(inputs)
    x = layers.Dense(64, name="first")(x)
    x = layers.BatchNormalization(scale=False, name="norm")(x)
    x = layers.Activation("relu")(x)
    return keras.Model(inputs, layers.Dense(91, name="last")(x))


def branching() -> keras.Model:
    inputs = keras.Input((91,))
    x = layers.Dense(91, activation="relu")(inputs)
    return keras.Model(inputs, layers.Add()([x, inputs]))


def two_ends() -> keras.Model:
    inputs = keras.Input((91,))
    x = layers.Dense(64, activation="relu")(inputs)
    return keras.Model(inputs, [x, layers.Dense(91)(x)])


def sequential(*items: keras.layers.Layer) -> keras.Model:
    return keras.Sequential([keras.Input((91,)), *items])


MODELS = {
    "plain": lambda: sequential(layers.Dense(64, activation="relu"), layers.Dense(91)),
    "norms": lambda: sequential(
        layers.BatchNormalization(),
        layers.Dense(64, use_bias=False),
        layers.BatchNormalization(epsilon=0.1, center=False),
        layers.ReLU(),
        layers.Dropout(0.5),
        layers.Dense(72, activation="relu", name="mine"),
        layers.BatchNormalization(),
        layers.GaussianNoise(0.1),
        layers.Dense(91, activation=keras.activations.relu),
    ),
    "no_bias": lambda: sequential(
        layers.Dense(64, activation="relu", use_bias=False), layers.Dense(91, use_bias=False)
    ),
    "functional": functional,
    "many": lambda: sequential(
        *(layers.Dense(16 + k, activation="relu") for k in range(11)), layers.Dense(91)
    ),
    # Refused.
    "branching": branching,
    "two_ends": two_ends,
    "leaky": lambda: sequential(layers.Dense(64), layers.LeakyReLU(), layers.Dense(91)),
    "slope": lambda: sequential(
        layers.Dense(64), layers.ReLU(negative_slope=0.1), layers.Dense(91)
    ),
    "relu6": lambda: sequential(layers.Dense(64), layers.ReLU(6.0), layers.Dense(91)),
    "tanh": lambda: sequential(layers.Dense(64, activation="tanh"), layers.Dense(91)),
    "layer_norm": lambda: sequential(
        layers.Dense(64), layers.LayerNormalization(), layers.ReLU(), layers.Dense(91)
    ),
    "nested": lambda: sequential(
        keras.Sequential([layers.Dense(64, activation="relu")]), layers.Dense(91)
    ),
    "end": lambda: sequential(layers.Dense(91, activation="relu"), layers.BatchNormalization()),
}


def main() -> None:
    folder, rng = Path(sys.argv[1]), np.random.default_rng(4)
    for name, make in MODELS.items():
        model = make()
        # Random, because Keras begins with biases of 0 and statistics of nothing.
        model.set_weights(
            [
                rng.uniform(0.3, 1.5, w.shape) if w.ndim == 1 else w
                for w in map(np.asarray, model.get_weights())
            ]
        )
        model.compile("adam", "mse")  # whose state is in the files as well
        for end in ENDS:
            (model.save_weights if end == ".weights.h5" else model.save)(folder / f"{name}{end}")
        inputs = np.load(folder / "poses.npy").reshape(-1, *model.input_shape[1:])
        outputs = model.predict(inputs, verbose=0)
        if not isinstance(outputs, list):
            np.save(folder / f"{name}.npy", outputs)


if __name__ == "__main__":
    main()
