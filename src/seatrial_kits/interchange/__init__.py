"""Systems for other tools and from them: SSP, OSP-IS, and rigs as FMUs."""
