"""Commands that run trials and campaigns."""
