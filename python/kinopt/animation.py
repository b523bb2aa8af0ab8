"""Motion over time: keyframes, what is between them, and poses."""

from ._kinopt.animation import EulerClip

__all__ = ["EulerClip"]
