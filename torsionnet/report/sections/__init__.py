"""The sections of a report, one module each; every one makes a :class:`Section` of a :class:`Subject`."""
