"""Design of dampers for the smallest maximum of a vibration."""
