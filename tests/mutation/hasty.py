"""For pytest: hypothesis tries the same examples every time, and does not look for the simplest that fails."""

from hypothesis import Phase, settings

settings.register_profile(
    "hasty", phases=(Phase.explicit, Phase.generate), derandomize=True, database=None, deadline=None
)
settings.load_profile("hasty")
