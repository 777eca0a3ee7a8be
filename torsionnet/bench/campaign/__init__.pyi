# Written by `make generate`.
from torsionnet.bench.campaign.campaign import Campaign as Campaign
from torsionnet.bench.campaign.campaign import load_campaign as load_campaign
from torsionnet.bench.campaign.campaign_result import CampaignResult as CampaignResult
from torsionnet.bench.campaign.campaign_result import ConditionSpread as ConditionSpread
from torsionnet.bench.campaign.running_campaign import run_campaign as run_campaign

__all__ = [
    "Campaign",
    "CampaignResult",
    "ConditionSpread",
    "load_campaign",
    "run_campaign",
]
