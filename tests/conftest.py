"""Settings of the whole suite."""

from hypothesis import HealthCheck, settings

# Deterministic examples: the same run finds the same failures everywhere.
settings.register_profile(
    "csgmesh",
    derandomize=True,
    deadline=None,
    max_examples=50,
    suppress_health_check=[HealthCheck.too_slow, HealthCheck.data_too_large],
)
settings.load_profile("csgmesh")
