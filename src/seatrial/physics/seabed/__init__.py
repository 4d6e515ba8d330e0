"""Seabed, obstacles and surface as geometry: depths, normals, ranges along rays."""
