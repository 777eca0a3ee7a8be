"""Sections of a report, one module each: every one builds a :class:`Section` from the :class:`ReportData`."""
