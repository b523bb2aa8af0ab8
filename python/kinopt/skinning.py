"""Skinning: moving a mesh with the handles it is bound to."""

from ._kinopt.skinning import SkinWeights

__all__ = ["SkinWeights"]
