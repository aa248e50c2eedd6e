"""What is refused stays a refusal, and costs nothing else."""

import subprocess
from pathlib import Path

import pytest
from builds import need

from reports.targets import INCLUDES, ROOT, SOURCES, library_flags, run

NULL_TO_ORIENT = r"""
#include <stdio.h>
#include <string.h>

#include "edmlift/stages.h"

int main(void)
{
    edml_point x[EDML_JOINTS] = {{1, 2, 3}}, same[EDML_JOINTS];
    edml_point_q24 y[EDML_JOINTS] = {{1, 2, 3}}, same_q[EDML_JOINTS];
    const edml_keypoint in[EDML_JOINTS] = {{0, 0, 1}};
    const edml_keypoint_q in_q[EDML_JOINTS] = {{0, 0, 1}};
    memcpy(same, x, sizeof x);
    memcpy(same_q, y, sizeof y);
    printf("%s %s %s %s", edml_status_name(edml_orient(NULL, in, 0x3FFF)),
           edml_status_name(edml_orient(x, NULL, 0x3FFF)),
           edml_status_name(edml_orient_q(NULL, in_q, 0x3FFF)),
           edml_status_name(edml_orient_q(y, NULL, 0x3FFF)));
    return memcmp(same, x, sizeof x) != 0 || memcmp(same_q, y, sizeof y) != 0;
}
"""

# The float network stretches an arm to more than 4 m, which edml_quality() refuses.
FAR = (
    "0.311195,-29.6047,1,10.385,50,1,-79.6557,50,1,-27.8016,-24.8873,1,143.219,-50,1,"
    "-68.8198,50,1,66.7691,-50,1,-64.3358,-50,1,-107.056,50,0,141.065,50,1,-86.8219,50,1,"
    "-25.3618,50,1,140.787,50,1,-69.2448,39.0672,1\n"
)


@pytest.fixture(scope="module")
def lift_stdin(tmp_path_factory: pytest.TempPathFactory) -> Path:
    need("gcc")
    program = tmp_path_factory.mktemp("program") / "lift_stdin"
    sources = sorted((ROOT / "examples" / "lift_stdin").glob("*.c"))
    run("gcc", *library_flags(), "-O1", *INCLUDES, *sources, *SOURCES, "-lm", "-o", program)
    return program


def test_a_null_pointer_is_an_argument_to_orient(tmp_path: Path) -> None:
    need("gcc")
    (tmp_path / "orient.c").write_text(NULL_TO_ORIENT)
    program = tmp_path / "orient"
    run("gcc", *library_flags(), *INCLUDES, tmp_path / "orient.c", *SOURCES, "-lm", "-o", program)
    assert run(program) == "argument argument argument argument"


@pytest.mark.parametrize("options", [[], ["--json"]])
def test_a_pose_without_quality_is_lifted_all_the_same(
    lift_stdin: Path, options: list[str]
) -> None:
    line = FAR
    if options:
        numbers = FAR.split(",")
        points = [",".join(numbers[k : k + 3]).strip() for k in range(0, 42, 3)]
        line = '{"keypoints":[[' + "],[".join(points) + "]]}\n"
    plain, rated = (
        subprocess.run([lift_stdin, *options, *more], input=line, capture_output=True, text=True)
        for more in ([], ["--quality"])
    )
    assert plain.returncode == rated.returncode == 0
    lifted = plain.stdout.rstrip("}\n")
    assert "ok" in lifted
    assert rated.stdout == lifted + (',"quality":0}\n' if options else ",0\n")
