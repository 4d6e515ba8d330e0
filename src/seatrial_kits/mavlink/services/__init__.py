"""Microservices of MAVLink: each answers its messages."""
