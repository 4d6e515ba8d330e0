"""Campaigns run whole, which a kit brings: see `seatrial_kits.campaigns.api`."""

from __future__ import annotations

from ..plugins import service

CampaignResult = service("campaigns.CampaignResult")
CaseResult = service("campaigns.CaseResult")
ask_campaign = service("campaigns.ask_campaign")
load_campaign_result = service("campaigns.load_campaign_result")
run_campaign = service("campaigns.run_campaign")
