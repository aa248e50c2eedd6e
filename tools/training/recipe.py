"""Recipes: everything that decides the weights of a network, besides the motion and the seed."""

import dataclasses

MAX_MISSING = 4  # most joints hidden in training: the lift refuses more


@dataclasses.dataclass(frozen=True)
class Recipe:
    """How a lifter is trained; ours is the default."""

    network: str = "distances"  # one of loss.NETWORKS, or of layout.KINDS
    hidden: tuple[int, ...] = (72, 72, 64)  # pairs of units a layer; of the equivariant networks
    l2_epochs: int = 0  # epochs of plain L2 on the distances ...
    pose_epochs: int = 840  # ... then on the error of the poses; of `direct` all
    batch: int = 128
    adam: bool = False  # the optimizer; else Muon
    rate: float = 1.5e-3
    drop_rate_at: float = 0.0  # share of the epochs when the rate falls to a tenth; 0: cosine
    clip: float = 0.5  # global norm of the gradient
    # The loss, in metres: of it the error after rigid alignment, the rest is that in camera axes;
    rigid: float = 0.4
    distance_weight: float = 0.5  # of the mean squared distance error, m^2
    direction_weight: float = 0.2  # of the mean difference of the bones' directions
    flexion_weight: float = 0.05  # a radian, of elbows and knees ...
    straight_weight: float = 0.06  # ... and again of those that are straight
    average: float = 0.999  # the saved weights are an exponential moving average; 0: the last ones
    dropout: float = 0.0
    iid: float = 0.5  # share of the poses with iid noise; the others get a detector's
    noise: float = 20.0  # pixels: iid noise is drawn with sigma up to this
    detector: float = 1.5  # detector-like noise is drawn up to this scale
    weak: float = 1.25  # the strength of either is u^weak, u uniform from 0 to 1, ...
    least: float = 0.0  # ... mapped onto least to 1
    bodies: bool = True  # vary height and proportions
    masks: bool = True  # hide joints
    impute: bool = True  # hidden joints are at their conditional mean (gen/imputation.h), not zero
    flip: bool = True  # mirror half of the motion, so that people are left-handed as often
    mix: float = 0.2  # share of the poses with the arms of another one, and with the legs
    straightened: float = 0.15  # share of the arms and legs that are made straight
    adapted: float = 0.25  # share of the poses whose head and neck are an adapter's ...
    redefined: float = 0.25  # ... and of those whose other joints are elsewhere for a detector
    near: float = 0.25  # share of the cameras at 1.5 to 3 m
    others: float = 0.3  # share of the poses from the motion files behind the first
    up: float = 0.5  # share of the poses of which the network is told where up is ...
    tilted: float = 0.1  # ... and of those, the share that is wrong by some 25 degrees
    fuse: bool = True  # the joint error is that behind the orient and fuse stages, not the MDS
    balance: float = 0.5  # a subject with n poses is drawn in proportion to n^(1 - balance)

    @property
    def epochs(self) -> int:
        """Of both phases."""
        return self.l2_epochs + self.pose_epochs


# What older recipes had: noise of all strengths alike, and more limbs of other poses.
EVEN_NOISE = {"weak": 1.0, "mix": 0.3}

# Through the distances to the MDS and nothing else: the paper's networks, better trained.
_MDS = EVEN_NOISE | {
    "batch": 64,
    "adam": True,
    "rate": 1e-3,
    "rigid": 0.7,
    "direction_weight": 0.0,
    "flexion_weight": 0.0,
    "straight_weight": 0.0,
    "straightened": 0.0,
    "redefined": 0.0,
}

RECIPES = {
    "distances": Recipe(),
    "direct": Recipe(network="direct", hidden=(88, 88, 88), pose_epochs=1000),
    "fconn": Recipe(network="fconn", l2_epochs=41, pose_epochs=209, **_MDS),
    "fconv": Recipe(network="fconv", l2_epochs=5, pose_epochs=25, **_MDS | {"rigid": 1.0}),
    "l2": Recipe(
        network="fconn", l2_epochs=1000, pose_epochs=0, **_MDS | {"rigid": 1.0, "fuse": False}
    ),
    # Section 3.2 of the paper: L2, Adam, batches of 200, dropout 0.5, 500 epochs, the rate
    # divided by ten after 250; no noise or occlusion unless asked for.
    "paper": Recipe(
        network="fconn",
        l2_epochs=500,
        pose_epochs=0,
        drop_rate_at=0.5,
        clip=0.0,
        average=0.0,
        dropout=0.5,
        noise=0.0,
        detector=0.0,
        bodies=False,
        masks=False,
        impute=False,
        flip=False,
        adapted=0.0,
        near=0.0,
        balance=0.0,
        **_MDS | {"mix": 0.0, "batch": 200, "rigid": 1.0, "fuse": False},
    ),
}


def scale_epochs(recipe: Recipe, epochs: int | None) -> Recipe:
    """The recipe with its epochs scaled to a total; None: as it is."""
    if epochs is None:
        return recipe
    l2 = round(epochs * recipe.l2_epochs / recipe.epochs)
    if recipe.l2_epochs > 0 and recipe.pose_epochs > 0:
        l2 = max(l2, epochs // 6)  # few as they are, they must get the MDS near enough
    return dataclasses.replace(recipe, l2_epochs=l2, pose_epochs=epochs - l2)
