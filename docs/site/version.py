"""The site's name with the version that its pages describe."""

from __future__ import annotations

from mkdocs.config.defaults import MkDocsConfig

import seatrial


def on_config(config: MkDocsConfig) -> MkDocsConfig:
    """Return the configuration with the version behind the name."""
    config.site_name = f"{config.site_name} {seatrial.__version__}"
    return config
