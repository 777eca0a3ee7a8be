"""Campaigns of rotating tests: records, orders beside the calculation, repeatability and fits from one file."""

from torsionnet.core.packages import lazy_exports

__all__, __getattr__, __dir__ = lazy_exports(
    __name__,
    {
        "Campaign": "torsionnet.campaign.campaign",
        "CampaignResult": "torsionnet.campaign.campaign_result",
        "ConditionSpread": "torsionnet.campaign.condition_spread",
        "load_campaign": "torsionnet.campaign.loading_campaign",
        "run_campaign": "torsionnet.campaign.running_campaign",
    },
)
