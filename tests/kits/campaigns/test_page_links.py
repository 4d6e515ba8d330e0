"""From a campaign's page down to a case, in a real browser: its report, or how to run it again."""

from __future__ import annotations

from pathlib import Path

import pytest

from seatrial_kits.campaigns.results.campaign_report import write_case_report
from seatrial_kits.campaigns.results.page import write_table_page
from seatrial_kits.campaigns.sweep import run_sweep
from tests.kits.live.browser import chromium, opened

from .test_table import direct

pytestmark = pytest.mark.interop

GRID = 'keep = "failed"\n[grid]\n"case.number" = ["1 m", "2 m", "3 m", "3.5 m", "4 m", "5 m"]\n'


def test_a_bar_and_a_row_lead_to_a_case(written, tmp_path: Path) -> None:
    """Cases 4 to 6 fail and have folders; the others can run again."""
    folder = tmp_path / "out"
    run_sweep(written(GRID), folder, direct())
    kept = sorted(path for path in folder.iterdir() if path.is_dir())
    for case in kept:
        write_case_report(case)
    address = write_table_page(folder).as_uri()
    with chromium() as browser:
        page = opened(browser, address, ".figure .main-svg")
        bars = page.locator(".figure .bars .point path")
        assert bars.count() == 6
        row = page.locator("table").last.get_by_role("link", name="6", exact=True)
        row.click()
        page.wait_for_url("**/06-*/report.html")
        page.go_back()
        page.locator(".figure .main-svg").first.wait_for()
        point = "document.querySelector('.figure').emit('plotly_click', {points: [{data: document.querySelector('.figure').data[0], pointNumber: %d}]})"
        page.evaluate(point % 1)
        said = page.locator("#case")
        assert "Case 2 has no folder here" in said.inner_text()
        assert (
            said.locator("code").inner_text()
            == "seatrial campaign rerun campaign.toml --engine direct --of out --case 2"
        )
        page.evaluate(point % 4)
        page.wait_for_url("**/05-*/report.html")
        assert not page.problems
