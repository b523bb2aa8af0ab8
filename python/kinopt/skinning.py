"""Skinning: deformation of a mesh by bones and handles.

- Bones: ``SkinWeights`` (given, by ``AutomaticWeights``, or by ``HeatWeights``), prepared as ``MeshWeights``, which
  skin vertices by linear blend ("lbs") or dual quaternions ("dqs").
- Points: ``PointHandle``, with transforms like those of bones. Cages: ``CageBinding``.
- ``MorphTargets`` deform the mesh at rest, before skinning; ``BlendShapes`` are whole shapes of it.
- ``BoneBoxes``: bounding boxes of skinned meshes, without skinning.
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
