"""Questions to campaigns: worst cases, limits, rare events, sensitivity, tuning."""
