"""Forces and moments wanted to the orders and angles of parts."""
