"""How fine: size fields, and what a `size=` argument means for a domain."""

from csgmesh.size.background import BackgroundSize
from csgmesh.size.combinations import minimum
from csgmesh.size.curvature import CurvatureSize
from csgmesh.size.feature import FeatureSize
from csgmesh.size.field import SizeField, UniformSize
from csgmesh.size.gradation import limit_gradation
from csgmesh.size.hessian import HessianSize
from csgmesh.size.near import NearSize
from csgmesh.size.region import RegionSize
from csgmesh.size.resolve import ResolvedSize, pointwise, resolve

__all__ = [
    "BackgroundSize",
    "CurvatureSize",
    "FeatureSize",
    "HessianSize",
    "NearSize",
    "RegionSize",
    "ResolvedSize",
    "SizeField",
    "UniformSize",
    "limit_gradation",
    "minimum",
    "pointwise",
    "resolve",
]
