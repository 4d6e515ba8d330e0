"""Whole vehicle files proposed from main particulars."""
