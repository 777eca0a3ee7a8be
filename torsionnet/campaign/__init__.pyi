# Written by `make generate`.
from torsionnet.campaign.campaign import Campaign as Campaign
from torsionnet.campaign.campaign_result import CampaignResult as CampaignResult
from torsionnet.campaign.condition_spread import ConditionSpread as ConditionSpread
from torsionnet.campaign.loading_campaign import load_campaign as load_campaign
from torsionnet.campaign.running_campaign import run_campaign as run_campaign

__all__ = [
    "Campaign",
    "CampaignResult",
    "ConditionSpread",
    "load_campaign",
    "run_campaign",
]
