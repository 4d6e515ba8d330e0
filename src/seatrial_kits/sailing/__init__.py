"""Sailing boats: rigid sail and hull, guidance, lookout, marks afloat."""
