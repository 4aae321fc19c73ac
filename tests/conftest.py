"""Settings of the whole suite."""

from hypothesis import HealthCheck, settings

from csgmesh import kernels

# Collecting doctests imports every module by its file; kernels imported so would keep their machine
# code in a second place, and each would be compiled twice.
for name in kernels._HOME:
    getattr(kernels, name)

# Deterministic examples: the same run finds the same failures everywhere.
settings.register_profile(
    "csgmesh",
    derandomize=True,
    deadline=None,
    max_examples=50,
    suppress_health_check=[HealthCheck.too_slow, HealthCheck.data_too_large],
)
settings.load_profile("csgmesh")
