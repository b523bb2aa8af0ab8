"""Everything public has a docstring, which says what it raises."""

import importlib
import inspect
import re

import pytest

import kinopt

MODULES = ["kinopt", "kinopt.animation", "kinopt.io", "kinopt.lerobot", "kinopt.methods", "kinopt.models", "kinopt.ray", "kinopt.rerun"]
MODULES += ["kinopt.retargeting", "kinopt.skinning", "kinopt.tasks", "kinopt.view"]
# These raise nothing: they have no arguments, or none that their signature does not check.
CANNOT_RAISE = {
    "kinopt.animation.Armature.without_scale",
    "kinopt.CollisionModel.to_srdf",
    "kinopt.Contact",
    "kinopt.animation.Reach",
    "kinopt.SphereModel.to_yaml",
    "kinopt.PoseBounds.pose",
    "kinopt.ReachMap.arrays",
    "kinopt.Reachability.explain",
    "kinopt.Skeleton.guess_hinges",
    "kinopt.PoseBounds.position",
    "kinopt.Model.neutral",
    "kinopt.Servo.stop",
    "kinopt.Model.to_json",
    "kinopt.Robot.neutral",
    "kinopt.Robot.without_loops",
    "kinopt.Skeleton.builder",
    "kinopt.Skeleton.to_json",
    "kinopt.Solution.explain",
    "kinopt.SolutionDerivative.explain",
    "kinopt.TriangleMesh.bounding_box",
    "kinopt.TriangleMesh.is_closed",
    "kinopt.TriangleMesh.signed_volume",
    "kinopt.TriangleMesh.vertex_normals",
    "kinopt.TriangleMesh.with_computed_normals",
    "kinopt.World",
    "kinopt.World.is_collision_allowed",
    "kinopt.World.to_json",
    "kinopt.animation.Armature.of_skeleton",
    "kinopt.animation.BoneMask.all",
    "kinopt.animation.BoneMask.none",
    "kinopt.animation.Clip.builder",
    "kinopt.animation.Clip.renamed",
    "kinopt.animation.Clip.with_fewer_keys",
    "kinopt.animation.ClipBuilder",
    "kinopt.animation.Pose.copy",
    "kinopt.SkeletonBuilder",
    "kinopt.animation.StateMachineRun",
    "kinopt.io.obj_to_text",
    "kinopt.MotionScore",
    "kinopt.RetargetReport",
    "kinopt.RetargetReport.missed",
    "kinopt.retargeting.ClipReport",
    "kinopt.retargeting.FootMotion",
    "kinopt.retargeting.HandReport",
    "kinopt.retargeting.LimitExcess",
    "kinopt.retargeting.LostContact",
    "kinopt.retargeting.LimitMet",
    "kinopt.retargeting.MapGuess",
    "kinopt.retargeting.ScoreTerm",
    "kinopt.retargeting.Spread",
    "kinopt.retargeting.Touching",
    "kinopt.methods.Ccd",
    "kinopt.methods.Fabrik",
    "kinopt.view.Body",
    "kinopt.view.Balance",
    "kinopt.view.Balance.refresh",
    "kinopt.view.Balance.remove",
    "kinopt.view.Body.box",
    "kinopt.view.Body.group",
    "kinopt.view.Body.holding",
    "kinopt.view.Body.pieces",
    "kinopt.view.Body.region",
    "kinopt.view.Body.remove",
    "kinopt.view.Body.short",
    "kinopt.view.Body.size",
    "kinopt.view.Body.standing",
    "kinopt.view.Clip",
    "kinopt.view.Clip.show",
    "kinopt.view.Obstacles",
    "kinopt.view.Obstacles.follow",
    "kinopt.view.Obstacles.mark",
    "kinopt.view.Obstacles.refresh",
    "kinopt.view.Obstacles.remove",
    "kinopt.view.Piece",
    "kinopt.view.PlayBar",
    "kinopt.view.PlayBar.choose",
    "kinopt.view.PlayBar.pause",
    "kinopt.view.PlayBar.play",
    "kinopt.view.PlayBar.remove",
    "kinopt.view.PlayBar.scrub",
    "kinopt.view.PlayBar.show",
    "kinopt.view.Scene.add_world",
    "kinopt.view.RobotBody",
    "kinopt.view.RobotBody.group",
    "kinopt.view.RobotBody.holding",
    "kinopt.view.RobotBody.pieces",
    "kinopt.view.RobotBody.remove",
    "kinopt.view.Scene",
    "kinopt.view.Scene.announce",
    "kinopt.view.Scene.clear",
    "kinopt.view.Scene.close",
    "kinopt.view.Scene.every_frame",
    "kinopt.view.Scene.forget",
    "kinopt.view.Movement",
    "kinopt.view.Movement.show",
    "kinopt.view.Scene.frame_all",
    "kinopt.view.Scene.place",
    "kinopt.view.Scene.show",
    "kinopt.view.Scene.snapshot",
    "kinopt.view.Scene.wait",
    "kinopt.view.Solid",
    "kinopt.view.Solid.moved",
    "kinopt.view.Solid.scaled",
    "kinopt.view.Target",
    "kinopt.view.Target.on_grab",
    "kinopt.view.Target.on_move",
    "kinopt.view.Target.on_release",
    "kinopt.view.Target.remove",
} | {f"kinopt.models.{name}" for name in [*kinopt.models.names(), "names"]}


def is_made_by_a_caller(found):
    """True if a class has a constructor of its own."""
    return found.__text_signature__ is not None or inspect.isfunction(found.__init__)


def public():
    """Every public object once: its name, the object, and true if it is callable."""
    seen = set()
    for module_name in MODULES:
        try:
            module = importlib.import_module(module_name)
        except ImportError:
            continue
        for name in module.__all__:
            found = getattr(module, name)
            if inspect.ismodule(found) or id(found) in seen or not (inspect.isclass(found) or inspect.isroutine(found)):
                continue
            seen.add(id(found))
            if not inspect.isclass(found):
                yield f"{module_name}.{name}", found, True
                continue
            fault = issubclass(found, BaseException)
            yield f"{module_name}.{name}", found, not fault and is_made_by_a_caller(found)
            for member in () if fault else dir(found):
                if not (member.startswith("_") or hasattr(object, member)):
                    attribute = inspect.getattr_static(found, member)
                    called = callable(attribute) or isinstance(attribute, (classmethod, staticmethod))
                    # Fields of dataclasses with defaults are values here; the docstring of their class describes them.
                    is_documented = called or isinstance(attribute, property) or inspect.isgetsetdescriptor(attribute)
                    if is_documented and id(attribute) not in seen:
                        seen.add(id(attribute))
                        yield f"{module_name}.{name}.{member}", getattr(found, member), called


@pytest.mark.parametrize(("name", "found", "called"), list(public()), ids=lambda value: str(value)[:60])
def test_docstrings_state_content_and_exceptions(name, found, called):
    docstring = inspect.getdoc(found) or ""
    assert len(docstring) > 10, f"{name} says nothing of itself"
    raises = re.search(r"\b[Rr]aises?\b|\w+Error\b", docstring)
    if called:
        assert raises or name in CANNOT_RAISE, f"{name} does not say what it raises"


def test_list_of_non_raising_names_exists():
    names = {name for name, _, called in public() if called}
    without_viewer = {name for name in CANNOT_RAISE if name.startswith("kinopt.view") and "kinopt.view.Scene" not in names}
    assert CANNOT_RAISE - names - without_viewer == set()


def test_every_field_is_documented():
    for module in (kinopt.tasks, kinopt.methods):
        for name in module.__all__:
            found = getattr(module, name)
            if not hasattr(found, "__dataclass_fields__"):
                continue
            docstring = " ".join(inspect.getdoc(base) or "" for base in found.__mro__[:-1]) + (module.__doc__ or "")
            for field in found.__dataclass_fields__:
                if field.startswith("_"):
                    continue
                assert re.search(rf"``{field}``|\b{field}\b", docstring), f"{name} says nothing of {field}"
