"""Quantities received over NMEA: what a network says of its boat, value by value.

`memory` holds the values by quantity, with source, age and priority; `outputs` are the ports that
a receiver shows them on, and `publishing` sets those; `directions` turns magnetic directions into
true ones, `targets` holds other ships. NMEA 2000 and NMEA 0183 read into them alike.
"""
