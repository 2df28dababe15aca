"""Work that is shared out over the processors of this machine."""
