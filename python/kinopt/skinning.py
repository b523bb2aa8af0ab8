"""Skinning: moving a mesh with the handles it is bound to.

- Bones: ``SkinWeights`` (given, by ``AutomaticWeights``, or by ``HeatWeights``), made ready as ``MeshWeights``,
  which move vertices by linear blend ("lbs") or dual quaternions ("dqs").
- Points: ``PointHandle``, whose transforms move skin as those of bones do. Cages: ``CageBinding``.
- ``MorphTargets`` shape the mesh at rest, before any of these; ``BlendShapes`` are whole poses of it.
- ``BoneBoxes``: boxes around skinned meshes that need no skinning.
"""

from ._kinopt.skinning import (
    AutomaticWeights,
    BlendShapes,
    BoneBoxes,
    CageBinding,
    HeatWeights,
    MeshWeights,
    MorphTarget,
    MorphTargets,
    PointHandle,
    SkinWeights,
)

__all__ = [
    "AutomaticWeights",
    "BlendShapes",
    "BoneBoxes",
    "CageBinding",
    "HeatWeights",
    "MeshWeights",
    "MorphTarget",
    "MorphTargets",
    "PointHandle",
    "SkinWeights",
]
