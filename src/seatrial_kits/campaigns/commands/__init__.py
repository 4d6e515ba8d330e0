"""Commands of campaigns: `seatrial run`, `compare` and `report` of a campaign."""
