"""MAVLink 2: a simulated vehicle as ground stations and companion computers see one.

`component` is what a rig uses. Below it `node` joins three things: `transport` (endpoints, one
`link` per peer, each with its `codec`), the `vehicle` (what all services read and change) and
the services, one protocol per file, which see messages and simulated time and nothing else.
"""
