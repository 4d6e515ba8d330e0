"""Campaigns of many cases: on all cores or a cluster, into a table, and questions asked."""
