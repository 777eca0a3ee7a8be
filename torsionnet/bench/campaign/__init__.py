"""Campaigns of rotating tests: records, orders beside the calculation, repeatability and fits from one file."""

from torsionnet.base.packages import lazy_exports

__all__, __getattr__, __dir__ = lazy_exports(
    __name__,
    {
        "Campaign": "torsionnet.bench.campaign.campaign",
        "CampaignResult": "torsionnet.bench.campaign.campaign_result",
        "ConditionSpread": "torsionnet.bench.campaign.campaign_result",
        "load_campaign": "torsionnet.bench.campaign.campaign",
        "run_campaign": "torsionnet.bench.campaign.running_campaign",
    },
)
