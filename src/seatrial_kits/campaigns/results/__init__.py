"""Results of campaigns: maps, findings, comparisons, pages."""
