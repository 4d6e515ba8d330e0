"""System structures of OSP-IS, as libcosim reads them, read and written."""
