"""Control of a sailing boat: guidance, heading, sail."""
