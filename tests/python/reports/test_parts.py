"""What optional parts cost is what their pages say."""

from dataclasses import replace

import pytest
from builds import need_core

from data.paths import DOCS
from reports import markdown, parts
from reports.command import Disagreement
from reports.targets import TARGETS

claims = pytest.mark.claims


@pytest.mark.slow
@pytest.mark.parametrize(
    "part",
    [
        pytest.param("angles", marks=claims("docs/angles.md", "angles_costs")),
        pytest.param("measure_body", marks=claims("docs/body.md", "measure_body_costs")),
        pytest.param("path_follow", marks=claims("docs/where-in-the-room.md", "path_follow_costs")),
    ],
)
def test_the_costs_of_a_part_are_those_of_its_page(part: str):
    for core in parts.CORES:
        need_core(TARGETS[core])
    parts.check(part, parts.measure(part))


def test_a_cost_that_is_not_the_page_s_is_found():
    page = DOCS / parts.PARTS["angles"]
    costs = []
    for row in markdown.read(page, "angles_costs").strip().splitlines()[2:]:
        core, call, *numbers = (cell.strip().replace(",", "") for cell in row.strip("|").split("|"))
        costs.append(parts.PartCost(core, call, *map(int, numbers)))
    assert len(costs) == 4
    parts.check("angles", costs)
    for changed in ({"code": costs[1].code + 1}, {"instructions": costs[1].instructions * 2}):
        other = [costs[0], replace(costs[1], **changed), *costs[2:]]
        with pytest.raises(Disagreement, match="Cortex-M4F"):
            parts.check("angles", other)
