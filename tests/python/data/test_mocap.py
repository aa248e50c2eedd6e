"""The motion capture reader, on small files made here and, where they are found, on CMU's."""

import subprocess
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from support import TEST, TRAIN, need_motion, run_tool

from data import mocap
from data.cmu import SETS
from data.mocap import Cleaning, MocapError, Motion, Trial
from edmlift.joints import INDEX, JOINTS

# ASF bones: parent, direction, length in inches (`length 1.0`), axis, channels.
ASF = {
    "lhipjoint": ("root", "1 0 0", 4, "0 0 0", ""),
    "lfemur": ("lhipjoint", "0 -1 0", 16, "0 0 0", "rx ry rz"),
    "ltibia": ("lfemur", "0 -1 0", 16, "0 0 90", "rx"),
    "rhipjoint": ("root", "-1 0 0", 4, "0 0 0", ""),
    "rfemur": ("rhipjoint", "0 -1 0", 16, "0 0 0", "rx ry rz"),
    "rtibia": ("rfemur", "0 -1 0", 16, "0 0 0", "rx"),
    "thorax": ("root", "0 1 0", 20, "0 0 0", "rx ry rz"),
    "head": ("thorax", "0 1 0", 10, "0 0 0", "rx ry rz"),
    "lclavicle": ("thorax", "1 0 0", 7, "0 0 0", "ry rz"),
    "lhumerus": ("lclavicle", "1 0 0", 11, "0 0 0", "rx ry rz"),
    "lradius": ("lhumerus", "1 0 0", 6, "0 0 0", "ry"),
    "lwrist": ("lradius", "1 0 0", 4, "0 0 0", ""),
    "rclavicle": ("thorax", "-1 0 0", 7, "0 0 0", "ry rz"),
    "rhumerus": ("rclavicle", "-1 0 0", 11, "0 0 0", "rx ry rz"),
    "rradius": ("rhumerus", "-1 0 0", 6, "0 0 0", "ry"),
    "rwrist": ("rradius", "-1 0 0", 4, "0 0 0", ""),
    "rhand": ("rwrist", "-1 0 0", 3, "0 0 0", "rx rz"),  # not on the way to a joint of ours
}
INCH = 0.0254
# Joints of that skeleton at rest, inches, relative to the root.
REST = {
    "head": (0, 30, 0),
    "neck_base": (0, 20, 0),
    "right_shoulder": (-7, 20, 0),
    "right_elbow": (-18, 20, 0),
    "right_wrist": (-28, 20, 0),
    "left_shoulder": (7, 20, 0),
    "left_elbow": (18, 20, 0),
    "left_wrist": (28, 20, 0),
    "right_hip": (-4, 0, 0),
    "right_knee": (-4, -16, 0),
    "right_ankle": (-4, -32, 0),
    "left_hip": (4, 0, 0),
    "left_knee": (4, -16, 0),
    "left_ankle": (4, -32, 0),
}
ARMS_DOWN = {"lhumerus": "0 0 -80", "rhumerus": "0 0 80"}  # or the frame would be a T-pose


def asf_text() -> str:
    lines = ["# made up", ":version 1.10", ":units", "  mass 1.0", "  length 1.0", "  angle deg"]
    lines += [":root", "order TX TY TZ RX RY RZ", "axis XYZ", "position 0 0 0"]
    lines += ["orientation 0 0 0", ":bonedata"]
    for number, (name, (_, direction, length, axis, dof)) in enumerate(ASF.items(), 1):
        lines += ["begin", f"id {number}", f"name {name}", f"direction {direction}"]
        lines += [f"length {length}", f"axis {axis} XYZ"]
        lines += [f"dof {dof}", "limits (-1.0 1.0)", "(-2.0 2.0)"] if dof else []
        lines += ["end"]
    lines += [":hierarchy", "begin"]
    for parent in ("root", *ASF):
        children = [name for name, bone in ASF.items() if bone[0] == parent]
        lines += [" ".join([parent, *children])] if children else []
    return "\n".join([*lines, "end", ""])


def amc_frame(number: int, root: str = "0 40 0 0 0 0", **bones: str) -> list[str]:
    """Lines of one frame; bones not given stay at rest."""
    lines = [str(number), f"root {root}"]
    for name, (*_, dof) in ASF.items():
        if dof:
            lines.append(f"{name} {bones.get(name, ' '.join('0' * len(dof.split())))}")
    return lines


def amc_text(*frames: list[str]) -> str:
    return "\n".join(["#!OML:ASF made up", ":FULLY-SPECIFIED", ":DEGREES", *sum(frames, []), ""])


@pytest.fixture
def skeleton(tmp_path: Path) -> mocap.Skeleton:
    (tmp_path / "07.asf").write_text(asf_text())
    return mocap.read_asf(tmp_path / "07.asf")


def read_frames(folder: Path, skeleton: mocap.Skeleton, *frames: list[str]) -> Trial:
    (folder / "07_01.amc").write_text(amc_text(*frames))
    return mocap.read_amc(folder / "07_01.amc", skeleton)


def assert_joint(joints: np.ndarray, name: str, inches: tuple[float, float, float]):
    np.testing.assert_allclose(
        joints[INDEX[name]], np.array(inches) * INCH, atol=1e-9, err_msg=name
    )


# ASF and AMC


def test_amc_at_rest(tmp_path: Path, skeleton: mocap.Skeleton):
    trial = read_frames(tmp_path, skeleton, amc_frame(1, root="1 40 3 0 0 0"))
    assert trial.joints.shape == (1, 14, 3) and trial.fps == 120
    for name, (x, y, z) in REST.items():
        assert_joint(trial.joints[0], name, (x + 1, y + 40, z + 3))


def test_amc_rotations_by_hand(tmp_path: Path, skeleton: mocap.Skeleton):
    first = amc_frame(1, rfemur="90 0 0", rtibia="-90", lradius="90", rclavicle="0 90")
    # x is turned first, then y, then z: -y goes to -z, to -x, to -y.
    second = amc_frame(2, lfemur="90 90 90")
    third = amc_frame(3, root="0 0 0 0 90 0")
    # The left shin's frame is turned by 90 about z: its x is the world's y, along the shin.
    fourth = amc_frame(4, ltibia="90")
    joints = read_frames(tmp_path, skeleton, first, second, third, fourth).joints
    assert_joint(joints[0], "right_knee", (-4, 40, -16))
    assert_joint(joints[0], "right_ankle", (-4, 24, -16))
    assert_joint(joints[0], "left_elbow", (18, 60, 0))
    assert_joint(joints[0], "left_wrist", (18, 60, -10))
    assert_joint(joints[0], "right_shoulder", (0, 53, 0))
    assert_joint(joints[0], "right_wrist", (0, 32, 0))
    assert_joint(joints[1], "left_knee", (4, 24, 0))
    assert_joint(joints[1], "left_ankle", (4, 8, 0))
    assert_joint(joints[2], "left_wrist", (0, 20, -28))
    assert_joint(joints[3], "left_ankle", (4, 8, 0))


def test_amc_frame_of_zeros_is_blank(tmp_path: Path, skeleton: mocap.Skeleton):
    trial = read_frames(tmp_path, skeleton, amc_frame(1, root="0 0 0 0 0 0"), amc_frame(2))
    assert trial.blank.tolist() == [True, False]


def replaced(lines: list[str], old: str, new: str | None) -> list[str]:
    """The lines with the one line `old` replaced, or dropped."""
    assert lines.count(old) == 1
    return [new if line == old else line for line in lines if line != old or new is not None]


# Frame 1 takes lines 4 to 18: its number, the root and 13 bones; frame 2 begins at line 19.
@pytest.mark.parametrize(
    ("lines", "where", "what"),
    [
        (replaced(amc_frame(1), "rtibia 0", "rtibia x"), 9, "not a number"),
        (replaced(amc_frame(1), "rtibia 0", "rtibia nan"), 9, "finite"),
        (replaced(amc_frame(1), "rtibia 0", "rtibia 0 0"), 9, "1 numbers expected, 2 found"),
        (replaced(amc_frame(1), "rtibia 0", "rtibia"), 9, "1 numbers expected, 0 found"),
        (replaced(amc_frame(1), "rtibia 0", "tail 0"), 9, "'tail'"),
        (replaced(amc_frame(1), "rtibia 0", None) + amc_frame(2), 18, "rtibia has 0 lines"),
        (amc_frame(1) + ["rtibia 0"] + amc_frame(2), 20, "rtibia has 2 lines"),
        (amc_frame(1) + amc_frame(2)[:4], 23, "has 0 lines"),
        (amc_frame(1)[1:], 4, "'root'"),
        (amc_frame(1) + amc_frame(3), 19, "frame 3 follows frame 1"),
        (amc_frame(1) + ["9" * 5000], 19, "is neither a frame number nor a bone"),
        ([], 3, "no frames"),
    ],
)
def test_broken_amc(tmp_path: Path, skeleton: mocap.Skeleton, lines, where: int, what: str):
    with pytest.raises(MocapError, match=f"07_01.amc:{where}: .*{what}"):
        read_frames(tmp_path, skeleton, lines)


@pytest.mark.parametrize(
    ("old", "new", "what"),
    [
        ("  length 1.0", "  length 0", "positive"),
        ("  length 1.0", "  mass 2.0", "1 numbers expected, 0 found"),
        ("  angle deg", "  angle rad", "angle deg"),
        ("order TX TY TZ RX RY RZ", "order TX TY TZ", "order"),
        ("position 0 0 0", "position 0 1 0", "position"),
        ("length 20", "length twenty", "not a number"),
        ("length 20", "", "without 'length'"),
        ("length 20", "length 0", "thorax has no length"),
        ("name head", "name skull", "head is not in :bonedata"),
        ("thorax head lclavicle rclavicle", "thorax lclavicle rclavicle", "head is missing"),
        ("rradius rwrist", "rradius rwrist head", "two parents"),
        (":hierarchy", ":tree", "without a section :hierarchy"),
        (":version 1.10", "version 1.10", "not an ASF file"),
    ],
)
def test_broken_asf(tmp_path: Path, old: str, new: str, what: str):
    text = asf_text()
    assert text.count(f"\n{old}\n") == 1
    path = tmp_path / "07.asf"
    path.write_text(text.replace(f"\n{old}\n", f"\n{new}\n"))
    with pytest.raises(MocapError, match=rf"07\.asf:\d+: .*{what}"):
        mocap.read_asf(path)


def test_asf_error_names_the_line(tmp_path: Path):
    lines = asf_text().splitlines()
    where = lines.index("name thorax")
    lines[where + 1] = "direction 0 1"
    (tmp_path / "07.asf").write_text("\n".join(lines))
    with pytest.raises(MocapError, match=f"07.asf:{where + 2}: 3 numbers expected, 2 found"):
        mocap.read_asf(tmp_path / "07.asf")


def test_cut_off_asf(tmp_path: Path):
    text = asf_text()
    (tmp_path / "07.asf").write_text(text[: text.index("name rhand")])
    with pytest.raises(MocapError, match=r"07\.asf:\d+: "):
        mocap.read_asf(tmp_path / "07.asf")


# BVH: the same skeleton with cgspeed's names; offsets in inches.
BVH = """HIERARCHY
ROOT Hips
{
  OFFSET 0 0 0
  CHANNELS 6 Xposition Yposition Zposition Zrotation Yrotation Xrotation
  JOINT LeftUpLeg { 4 0 0
    JOINT LeftLeg { 0 -16 0
      JOINT LeftFoot { 0 -16 0
      End Site { 0 0 6
  }}}}
  JOINT RightUpLeg { -4 0 0
    JOINT RightLeg { 0 -16 0
      JOINT RightFoot { 0 -16 0
      End Site { 0 0 6
  }}}}
  JOINT Spine { 0 10 0
    JOINT Neck { 0 10 0
      JOINT Head { 0 4 0
      End Site { 0 6 0
    }}}
    JOINT LeftShoulder { 0 10 0
      JOINT LeftArm { 7 0 0
        JOINT LeftForeArm { 11 0 0
          JOINT LeftHand { 10 0 0
          End Site { 3 0 0
    }}}}}
    JOINT RightShoulder { 0 10 0
      JOINT RightArm { -7 0 0
        JOINT RightForeArm { -11 0 0
          JOINT RightHand { -10 0 0
          End Site { -3 0 0
    }}}}}
  }
}
"""
ROOT_CHANNELS = next(line for line in BVH.splitlines() if "CHANNELS 6" in line)
BVH_ORDER = [line.split()[1] for line in BVH.splitlines() if "JOINT" in line or "ROOT" in line]


def bvh_text(*frames: dict[str, str], head: str = BVH, count: int | None = None) -> str:
    """A BVH file; a frame maps joints to their channels, those not given stay at rest."""
    lines = []
    for line in head.splitlines():
        name, brace, offset = line.partition(" { ")
        if brace:
            lines += [name, "{", f"OFFSET {offset}"]
            lines += [] if "End" in name else ["CHANNELS 3 Zrotation Yrotation Xrotation"]
        elif set(line.strip()) == {"}"}:
            lines += ["}"] * line.count("}")
        else:
            lines.append(line)
    lines += ["MOTION", f"Frames: {len(frames) if count is None else count}"]
    lines.append("Frame Time: 0.01")
    rest = {name: "0 0 0" for name in BVH_ORDER} | {"Hips": "0 40 0 0 0 0"}
    lines += [" ".join((rest | frame).values()) for frame in frames]
    return "\n".join([*lines, ""])


def read_bvh(folder: Path, text: str, **options) -> Trial:
    (folder / "07_02.bvh").write_text(text)
    return mocap.read_bvh(folder / "07_02.bvh", unit=INCH, **options)


def test_bvh_at_rest(tmp_path: Path):
    trial = read_bvh(tmp_path, bvh_text({"Hips": "1 40 3 0 0 0"}))
    assert trial.fps == pytest.approx(100)
    for name, (x, y, z) in REST.items():
        assert_joint(trial.joints[0], name, (x + 1, y + 40, z + 3))


def test_bvh_rotations_by_hand(tmp_path: Path):
    # z y x as listed, each about the axes already turned: x is applied to the bone first.
    joints = read_bvh(
        tmp_path,
        bvh_text(
            {"RightUpLeg": "0 0 90", "LeftArm": "0 90 0"},
            {"LeftUpLeg": "90 90 90"},
            {"Hips": "0 0 0 0 90 0"},
        ),
    ).joints
    assert_joint(joints[0], "right_ankle", (-4, 40, -32))
    assert_joint(joints[0], "left_wrist", (7, 60, -21))
    assert_joint(joints[1], "left_knee", (4, 24, 0))
    assert_joint(joints[2], "left_wrist", (0, 20, -28))


def test_bvh_with_the_old_names(tmp_path: Path):
    old = BVH.replace("Shoulder {", "Collar {")
    names = ("Arm", "Shoulder"), ("ForeArm", "Elbow"), ("Hand", "Wrist")
    names += ("UpLeg", "Hip"), ("Leg", "Knee"), ("Foot", "Ankle")
    for side in ("Left", "Right"):
        for new_name, old_name in names:
            old = old.replace(f"JOINT {side}{new_name} ", f"JOINT {side}{old_name} ")
    trial = read_bvh(tmp_path, bvh_text({}, head=old))
    for name, (x, y, z) in REST.items():
        assert_joint(trial.joints[0], name, (x, y + 40, z))


@pytest.mark.parametrize(
    ("text", "what"),
    [
        (bvh_text({}, {}, count=3), "3 frames announced, 2 found"),
        (bvh_text({}, count=0), "0 frames announced, 1 found"),
        (bvh_text({"Head": "0 0"}), "57 numbers expected, 56 found"),
        (bvh_text({"Head": "0 0 inf"}), "finite"),
        (bvh_text({"Head": "0 0 zero"}), "not a number"),
        (bvh_text({}).replace("Frame Time: 0.01", "Frame Time: 0"), "positive"),
        (bvh_text({}).replace("Frame Time: 0.01\n", ""), "'Frame Time:' expected"),
        (bvh_text({}).replace("CHANNELS 3", "CHANNELS 4", 1), "CHANNELS 4, but 3 names"),
        (bvh_text({}).replace("OFFSET 0 4 0", "OFFSET 0 4"), "3 numbers expected, 2 found"),
        (bvh_text({}).replace("OFFSET 0 4 0\n", ""), "Head ends without OFFSET"),
        (bvh_text({}, head=BVH.replace(ROOT_CHANNELS, "")), "Hips ends without OFFSET or CHAN"),
        (bvh_text({}).replace("ROOT", "JOINT"), "'JOINT Hips' is not expected"),
        (bvh_text({}).replace("JOINT Spine", "ROOT Spine"), "'ROOT Spine' is not expected"),
        (bvh_text({}).replace("}\nMOTION", "MOTION"), "'MOTION' is not expected"),
        (bvh_text({}).partition("MOTION")[0], "before MOTION"),
        (bvh_text({}).replace("JOINT Neck", "JOINT Hals"), "no joint for neck"),
        (bvh_text({}).replace("JOINT Neck", "JOINT Spine"), "second joint Spine"),
        ("", "before MOTION"),
    ],
)
def test_broken_bvh(tmp_path: Path, text: str, what: str):
    with pytest.raises(MocapError, match=rf"07_02\.bvh:\d+: .*{what}"):
        read_bvh(tmp_path, text)


def test_bvh_error_names_the_line(tmp_path: Path):
    text = bvh_text({}, {"Head": "0 0"}, {})
    last = len(text.splitlines())
    with pytest.raises(MocapError, match=f"07_02.bvh:{last - 1}: 57 numbers expected"):
        read_bvh(tmp_path, text)


# What the cgspeed conversion does: the thorax's and wrists' lengths are gone.
LOST = BVH.replace("{ 0 10 0\n    JOINT Neck", "{ 0 0 0\n    JOINT Neck")
LOST = LOST.replace("JOINT Neck { 0 10 0", "JOINT Neck { 0 0 0")
LOST = LOST.replace("Shoulder { 0 10 0", "Shoulder { 0 0 0")


def test_bvh_without_a_bones_length_is_refused(tmp_path: Path):
    text = bvh_text({}, head=LOST)
    line = 1 + text.splitlines().index("    JOINT Neck") + 2
    with pytest.raises(MocapError, match=f"07_02.bvh:{line}: Neck .*--offsets"):
        read_bvh(tmp_path, text)


def test_offsets_restore_a_lost_bone(tmp_path: Path, skeleton: mocap.Skeleton):
    trial = read_bvh(tmp_path, bvh_text({}, head=LOST), offsets_from=skeleton)
    for name, (x, y, z) in REST.items():
        assert_joint(trial.joints[0], name, (x, y + 40, z))


def test_offsets_of_another_person_are_refused(tmp_path: Path, skeleton: mocap.Skeleton):
    other = LOST.replace("RightLeg { 0 -16 0", "RightLeg { 0 -15 0")
    with pytest.raises(MocapError, match=r"07_02\.bvh:\d+: .*another person"):
        read_bvh(tmp_path, bvh_text({}, head=other), offsets_from=skeleton)


# Cleaning


def standing(count: int) -> np.ndarray:
    """Poses [F,14,3] of a person with lowered arms who swings the right leg, 10 mm a frame."""
    joints = np.array([REST[name] for name in JOINTS]) * INCH + [0, 1, 0]
    for side in ("right", "left"):
        shoulder = joints[INDEX[f"{side}_shoulder"]]
        joints[INDEX[f"{side}_elbow"]] = shoulder + [0, -0.28, 0]
        joints[INDEX[f"{side}_wrist"]] = shoulder + [0, -0.53, 0]
    poses = np.repeat(joints[None], count, 0)
    poses[:, INDEX["right_ankle"], 2] += 0.010 * np.arange(count)
    return poses


def kept(
    joints: np.ndarray, fps: float = 120.0, rate: float = 15.0, **settings: float
) -> list[int]:
    """Frames of a trial at `fps` that are kept at `rate`."""
    trial = Trial(joints, np.zeros(len(joints), bool), fps)
    return mocap.clean(trial, Cleaning(fps=rate, **settings)).tolist()


def test_clean_thins_to_the_rate():
    assert kept(standing(33), min_move=0) == [0, 8, 16, 24, 32]
    assert kept(standing(33), fps=60.0, min_move=0) == [0, 4, 8, 12, 16, 20, 24, 28, 32]
    assert kept(standing(4), fps=120.0, min_move=0) == [0]


def test_clean_drops_frames_that_hardly_moved():
    # One of 14 joints moves: 20 mm on average are 280 mm of it, 28 frames.
    assert kept(standing(90), fps=120, min_move=0.0199) == [0, 32, 64]
    assert kept(standing(90), fps=15, min_move=0.0199) == [0, 28, 56, 84]
    walked = standing(90)
    walked[:, :, 0] += 0.05 * np.arange(90)[:, None]  # moving along is no new pose
    assert kept(walked, fps=15, min_move=0.0199) == [0, 28, 56, 84]


def every_frame(joints: np.ndarray) -> list[int]:
    """Frames kept if none is thinned out."""
    return kept(joints, fps=120.0, rate=120.0, min_move=0)


def test_clean_drops_jumps_and_a_tenth_of_a_second_around_them():
    joints = standing(60)
    joints[30, INDEX["left_wrist"], 0] += 0.5  # 60 m/s at 120 frames a second
    assert kept(joints, min_move=0) == [0, 8, 16, 48, 56]
    assert set(range(60)) - set(every_frame(joints)) == set(range(29 - 12, 31 + 12 + 1))
    assert kept(joints, min_move=0, max_joint_speed=61.0) == [*range(0, 60, 8)]


def test_clean_drops_a_pelvis_that_jumps():
    joints = standing(60)
    joints[30:] += [0.2, 0, 0]  # 24 m/s, no joint moves relative to the root
    assert set(range(60)) - set(every_frame(joints)) == set(range(29 - 12, 30 + 12 + 1))


def test_clean_drops_t_poses_and_blank_frames_only():
    joints = standing(40)
    joints[:10] = np.array([REST[name] for name in JOINTS]) * INCH
    assert mocap.is_t_pose(joints).tolist() == [True] * 10 + [False] * 30
    assert every_frame(joints) == list(range(10, 40))
    blank = np.arange(40) % 2 == 1
    assert (mocap.clean(Trial(joints, blank, 15.0), Cleaning(min_move=0)) % 2 == 0).all()


def test_t_pose_in_any_direction():
    joints = np.array([[REST[name] for name in JOINTS]]) * INCH
    turned = Rotation.from_euler("xyz", [20, 130, -10], degrees=True).apply(joints[0])[None]
    assert mocap.is_t_pose(turned).all()
    assert not mocap.is_t_pose(standing(1)).any()


# Folders


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """CMU's layout: one good trial of three poses, one BVH, three broken files."""
    subject = tmp_path / "subjects" / "07"
    subject.mkdir(parents=True)
    (subject / "07.asf").write_text(asf_text())
    swings = [amc_frame(n + 1, rfemur=f"{n} 0 0", **ARMS_DOWN) for n in range(41)]
    (subject / "07_03.amc").write_text(amc_text(*swings))
    (subject / "07_04.amc").write_text(amc_text(amc_frame(1)[:5]))
    (subject / "08_01.amc").write_text(amc_text(amc_frame(1)))  # there is no 08.asf
    (subject / "notes.amc").write_text("")
    arms = {"LeftArm": "-80 0 0", "RightArm": "80 0 0"}
    (tmp_path / "09_01.bvh").write_text(bvh_text(arms, arms))
    return tmp_path


def test_folder_skips_and_counts_broken_files(folder: Path, capsys: pytest.CaptureFixture):
    motion = mocap.read_folder(folder, Cleaning(bvh_unit=INCH))
    assert sorted(set(motion.subject)) == [7, 9]
    assert set(motion.trial[motion.subject == 7]) == {3}
    assert motion.frame[motion.subject == 7][0] == 0
    assert (motion.frame % 8 == 0)[motion.subject == 7].all()
    assert motion.joints.dtype == np.float32
    assert (motion.action == -1).all() and motion.action_names == ()
    assert motion.source == folder.name
    err = capsys.readouterr().err
    assert "07_04.amc:9: " in err and "08.asf: " in err and "notes.amc: " in err
    assert f"2 files read, 3 skipped, {len(motion.joints)} poses kept" in err


def test_folder_with_nothing_usable(tmp_path: Path):
    with pytest.raises(MocapError, match=f"{tmp_path.name}: no .amc or .bvh file"):
        mocap.load_motion(tmp_path)
    (tmp_path / "notes.amc").write_text("")
    with pytest.raises(MocapError, match=f"{tmp_path.name}: not one usable frame"):
        mocap.load_motion(tmp_path)


def run_mocap(*arguments: str | Path) -> subprocess.CompletedProcess:
    return run_tool("data.mocap", *arguments)


def test_command_line(folder: Path):
    out = folder / "out.npz"
    done = run_mocap(folder, "--out", out, "--bvh-unit", INCH, "--min-move", 0)
    assert done.returncode == 0, done.stderr
    assert "3 skipped" in done.stderr
    motion = mocap.load_motion(out)
    assert motion.frame[motion.subject == 7].tolist() == [0, 8, 16, 24, 32, 40]
    first = out.read_bytes()
    run_mocap(folder, "--out", out, "--bvh-unit", INCH, "--min-move", 0)
    assert out.read_bytes() == first


def test_command_line_fails_with_one_line(tmp_path: Path):
    done = run_mocap(tmp_path, "--out", tmp_path / "out.npz")
    assert done.returncode == 1
    assert done.stderr.startswith("mocap: ") and done.stderr.count("\n") == 1


# .npz files


def npz(path: Path, **changes) -> Path:
    """Writes a valid file but for the changes; a change to None drops the key."""
    data = {
        "joints": standing(3).astype(np.float32),
        "subject": np.array([1, 1, 2], np.int16),
        "trial": np.array([1, 1, 5], np.int16),
        "frame": np.array([0, 8, 0]),
        "joint_names": np.array(JOINTS),
        "up": "y",
        "unit": "m",
    } | changes
    file = path / "poses.npz"
    np.savez(file, **{key: value for key, value in data.items() if value is not None})
    return file


def test_load_npz(tmp_path: Path):
    motion = mocap.load_motion(npz(tmp_path))
    np.testing.assert_array_equal(motion.joints, standing(3).astype(np.float32))
    assert motion.subject.tolist() == [1, 1, 2] and motion.trial.tolist() == [1, 1, 5]
    assert motion.action.tolist() == [-1] * 3 and motion.action_names == ()
    assert motion.source == "poses.npz"


def test_load_npz_with_actions_and_short_names(tmp_path: Path):
    short = [name.replace("right_", "r_").replace("left_", "l_") for name in JOINTS]
    file = npz(
        tmp_path,
        joint_names=np.array(short),
        action=np.array([0, 0, 1], np.int8),
        action_names=np.array(["walk", "run"]),
        approx=np.zeros(3, np.uint8),
    )
    motion = mocap.load_motion(file)
    assert motion.action.tolist() == [0, 0, 1] and motion.action_names == ("walk", "run")


def swapped_names() -> np.ndarray:
    names = np.array(JOINTS)
    names[[2, 5]] = names[[5, 2]]
    return names


def with_nan() -> np.ndarray:
    joints = standing(3)
    joints[1, 4, 2] = np.nan
    return joints


NO_LETTERS = np.full(14, 0x110000, "u4").view("U1")


@pytest.mark.parametrize(
    ("changes", "what"),
    [
        ({"joint_names": swapped_names()}, "joint 2 is 'left_shoulder', must be 'right_shoulder'"),
        ({"joint_names": np.array(JOINTS[:13])}, "13 joint names, must be 14"),
        ({"unit": "mm"}, "unit is 'mm', must be 'm'"),
        ({"up": "z"}, "up is 'z', must be 'y'"),
        ({"joints": with_nan()}, "frame 1, right_wrist is not finite"),
        ({"joints": standing(3) * 1000}, r"units look wrong: .* times a person's"),
        ({"joints": standing(3) * 0.3}, "units look wrong"),
        ({"joints": standing(3)[:, :13]}, r"shape \(3, 13, 3\)"),
        ({"frame": np.arange(2), "action": np.zeros(3)}, "frame has shape"),
        ({"trial": None}, "key 'trial' is missing"),
        ({"joints": standing(3).astype(str)}, "joints is of type <U32, must be numbers"),
        ({"subject": np.zeros(3, "M8[s]")}, r"subject is of type datetime64\[s\], must be numbers"),
        ({"action_names": np.arange(3)}, "action_names is of type int64, must be text"),
        ({"action_names": np.array("walk")}, "action_names has 0 dimensions, must have 1"),
        ({"unit": "m\nm"}, "unit is 'm m', must be 'm'$"),
        ({"joint_names": NO_LETTERS}, "text with the code 0x110000, which is of no letter"),
        ({"unit": np.array(["m"])}, "unit has 1 dimensions, must have 0"),
        (
            {key: np.zeros(0, int) for key in ("subject", "trial", "frame")}
            | {"joints": np.zeros((0, 14, 3))},
            "no frames",
        ),
    ],
)
def test_load_npz_refuses(tmp_path: Path, changes: dict, what: str):
    with pytest.raises(MocapError, match=rf"poses\.npz: .*{what}"):
        mocap.load_motion(npz(tmp_path, **changes))


def test_load_npz_names_the_wrong_factor(tmp_path: Path):
    # 62 inches from the head's top to the ankles, and 4 aside.
    with pytest.raises(MocapError, match=r"is 1578 m \(median\), 986.3 times a person's"):
        mocap.load_motion(npz(tmp_path, joints=standing(3) * 1000))


def test_load_unreadable_npz(tmp_path: Path):
    file = npz(tmp_path)
    file.write_bytes(file.read_bytes()[:1000])
    with pytest.raises(MocapError, match=r"poses\.npz: not a readable .npz"):
        mocap.load_motion(file)
    with pytest.raises(MocapError, match=r"none\.npz: no such file"):
        mocap.load_motion(tmp_path / "none.npz")


def test_load_npz_checks_the_size_before_it_takes_memory(tmp_path: Path, monkeypatch):
    file = npz(tmp_path, joints=np.zeros((50_000, 14, 3)))
    monkeypatch.setattr(mocap, "LARGEST", 10 << 20)
    monkeypatch.setattr("zipfile.ZipFile.open", None)  # nothing is unpacked
    with pytest.raises(MocapError, match=r"unpacked archive takes 16 MB, at most 10 are read"):
        mocap.load_motion(file)


# CMU's own data, where a folder of the project's layout is found


def of_trial(motion: Motion, subject: int, trial: int) -> tuple[np.ndarray, np.ndarray]:
    """Joints and frames of one trial."""
    here = (motion.subject == subject) & (motion.trial == trial)
    return motion.joints[here], motion.frame[here]


@pytest.mark.slow
@pytest.mark.parametrize(("subject", "file"), [(16, TRAIN), (2, TEST)])
def test_raw_trials_reproduce_the_npz(subject: int, file: str):
    known = mocap.load_motion(need_motion(file))
    folder = need_motion(f"cmu_raw/subjects/{subject:02d}")
    read = mocap.load_motion(folder)
    for trial in np.unique(read.trial):
        joints, frames = of_trial(read, subject, trial)
        known_joints, known_frames = of_trial(known, subject, trial)
        assert frames.tolist() == known_frames.tolist()
        np.testing.assert_allclose(joints, known_joints, atol=0.001)


@pytest.mark.parametrize(("name", "file"), [("train", TRAIN), ("test", TEST)])
def test_the_sets_are_the_data_that_were_used(name: str, file: str):
    known = mocap.load_motion(need_motion(file))
    used = set(zip(known.subject.tolist(), known.trial.tolist(), strict=True))
    assert used - {(901, 1), (902, 1)} == SETS[name]  # those two are not in the archive


def test_a_set_is_read_from_among_other_trials():
    folder = need_motion("cmu_raw/subjects/02")
    all_of_it = mocap.read_folder(folder)
    one = mocap.read_folder(folder, only=frozenset({(2, 1)}))
    assert set(one.trial) == {1} < set(all_of_it.trial)
    with pytest.raises(MocapError, match="no .amc or .bvh file of the set"):
        mocap.read_folder(folder, only=SETS["train"])


def test_cgspeed_bvh_is_refused():
    with pytest.raises(MocapError, match=r"12_01_cgspeed\.bvh:\d+: Neck "):
        mocap.read_bvh(need_motion("cmu_raw/12_01_cgspeed.bvh"))


def test_cgspeed_bvh_has_the_legs_right():
    path = need_motion("cmu_raw/12_01_cgspeed.bvh")
    nodes, _ = mocap._bvh_nodes(mocap.TextFile(path), mocap.CGSPEED_UNIT)
    # Subject 12's skeleton is not at hand; with made-up bones for the lost ones the legs hold.
    bones = {"rfemur": nodes["RightLeg"].offset, "thorax": np.array([0, 0.1, 0])}
    bones |= {"rwrist": np.array([-0.08, 0, 0]), "lwrist": np.array([0.08, 0, 0])}
    skeleton = mocap.Skeleton(
        {n: mocap.Bone(n, "", offset, Rotation.identity(), ()) for n, offset in bones.items()}, 1.0
    )
    trial = mocap.read_bvh(path, offsets_from=skeleton)
    # The BVH's first frame is a T-pose that the original does not have.
    assert mocap.is_t_pose(trial.joints).nonzero()[0].tolist() == [0]
    known, frames = of_trial(mocap.load_motion(need_motion(TEST)), 12, 1)
    legs = slice(INDEX["right_hip"], INDEX["left_ankle"] + 1)
    np.testing.assert_allclose(trial.joints[frames + 1, legs], known[:, legs], atol=0.001)
