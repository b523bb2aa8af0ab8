"""Derivatives of solutions, from Python, in PyTorch and in JAX, equal the differences of new solutions."""

import pickle
from pathlib import Path

import numpy as np
import pytest

import kinopt
from kinopt import _solving, tasks

MODELS = Path(__file__).parents[2] / "models"
START = [0.3, -1.1, 1.0, -0.9, 1.1, 0.4]


@pytest.fixture(scope="module")
def robot():
    return kinopt.Robot.from_urdf(MODELS / "universal_ur5e.urdf")


@pytest.fixture(scope="module")
def arm(robot):
    return kinopt.Arm(robot, "base", "flange", position_tolerance=1e-12, orientation_tolerance=1e-12)


@pytest.fixture(scope="module")
def targets(arm):
    generator = np.random.default_rng(4)
    return arm.base_from_tool(START + generator.uniform(-0.2, 0.2, (5, 6)))


def own_axes(target):
    twists = np.zeros((6, 6))
    twists[:3, :3] = twists[3:, 3:] = target[:3, :3]
    return twists


def moved(target, twist):
    """The target moved along and about its own axes, to second order."""
    moved = target.copy()
    moved[:3, 3] += target[:3, :3] @ twist[:3]
    x, y, z = twist[3:]
    turn = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0.0]])
    u, _, v = np.linalg.svd(np.eye(3) + turn + 0.5 * turn @ turn)
    moved[:3, :3] = target[:3, :3] @ (u @ v)
    return moved


def test_arm_derivative_predicts_moved_targets(arm, targets):
    q = arm.solve_batch(targets, START).q
    many = arm.derivative(targets, q)
    assert many.by_target.shape == (5, 6, 6)
    assert many.is_unique.all() and many.differentiability == ["unique"] * 5
    for k in range(5):
        one = arm.derivative(targets[k], q[k])
        assert one.is_unique is True and one.differentiability == "unique"
        np.testing.assert_array_equal(one.by_target, many.by_target[k])
        followed = arm.jacobian(q[k]) @ one.by_target
        np.testing.assert_allclose(followed, own_axes(targets[k]), atol=1e-8)


def test_wrong_shapes_raise(arm, targets):
    with pytest.raises(kinopt.InvalidValueError, match="4 targets, but 5 rows"):
        arm.derivative(targets[:4], np.tile(START, (5, 1)))
    with pytest.raises(kinopt.InvalidValueError):
        arm.derivative(targets[0], START[:5])


@pytest.fixture(scope="module")
def problem(robot):
    """A redundant problem: a position for the hand, a posture for the rest."""
    hand = tasks.Point("flange", [0.4, 0.3, 0.4], name="hand")
    posture = tasks.Posture(START, name="posture")
    return kinopt.Problem(robot, [hand, posture])


def test_velocity_gradient_and_matrix_agree(problem):
    solution = kinopt.Solver().solve(problem, START)
    assert solution.reached
    derivative = problem.derivative(solution.q)
    assert derivative.is_unique and derivative.differentiability == "unique"
    assert "differentiable" in derivative.explain()
    by_hand = derivative.by_target("hand")
    assert by_hand.shape == (6, 3)
    rate = np.array([0.3, -0.2, 0.5])
    np.testing.assert_allclose(derivative.velocity({"hand": rate}), by_hand @ rate, atol=1e-9)
    slope = np.arange(6.0)
    gradient = derivative.gradient(slope)
    np.testing.assert_allclose(gradient["targets"]["hand"], slope @ by_hand, atol=1e-8)
    by_posture = derivative.by_target("posture")
    np.testing.assert_allclose(gradient["targets"]["posture"], slope @ by_posture, atol=1e-8)
    # Without balls the numbers of q are those of a velocity.
    again = derivative.gradient(by_q=slope)
    np.testing.assert_array_equal(again["weights"], gradient["weights"])
    link = derivative.velocity(joint_origins={"joint2": [0.0, 0.0, 1.0]})
    np.testing.assert_allclose(gradient["joint_origins"]["joint2"][2], slope @ link, atol=1e-7)
    weight = derivative.velocity(weights=[1.0, 0.0])
    np.testing.assert_allclose(gradient["weights"][0], slope @ weight, atol=1e-8)
    restored = pickle.loads(pickle.dumps(derivative))
    np.testing.assert_array_equal(restored.by_target("hand"), by_hand)


def test_targets_of_the_solve_are_used(problem):
    targets = {"hand": [0.35, 0.32, 0.45]}
    solution = kinopt.Solver().solve(problem, START, targets=targets)
    derivative = problem.derivative(solution.q, targets)
    assert derivative.is_unique
    step = 2e-2
    moved = [
        kinopt.Solver().solve(problem, solution.q, targets={"hand": targets["hand"] + by}).q
        for by in (np.array([step, 0, 0]), np.array([-step, 0, 0]))
    ]
    shown = (moved[0] - moved[1]) / (2 * step)
    # Within the accuracy of preferences.
    np.testing.assert_allclose(derivative.by_target("hand")[:, 0], shown, atol=0.1)


def test_unknown_names_raise(problem):
    derivative = problem.derivative(kinopt.Solver().solve(problem, START).q)
    with pytest.raises(kinopt.UnknownNameError, match="foot"):
        derivative.by_target("foot")
    with pytest.raises(kinopt.UnknownNameError, match="elbow"):
        derivative.velocity(joint_origins={"elbow": [0, 0, 1]})
    with pytest.raises(kinopt.InvalidValueError):
        derivative.gradient([1.0])
    with pytest.raises(kinopt.InvalidValueError, match="either"):
        derivative.gradient()


def test_unsolved_configuration_is_reported(problem):
    unreachable = {"hand": [3.0, 0.0, 0.0]}
    derivative = problem.derivative(START, unreachable)
    assert derivative.differentiability == "not_stationary" and not derivative.is_unique


def test_free_base_maps_quaternion_gradients(robot):
    body = kinopt.Robot.from_urdf(MODELS / "universal_ur5e.urdf", base_joint="free")
    q = np.concatenate([[0.1, 0.2, 0.3], [0.8, 0.2, -0.4, 0.4], START])
    q[3:7] /= np.linalg.norm(q[3:7])
    at = kinopt.frame_placement(body, "flange", q)
    problem = kinopt.Problem(
        body, [tasks.Pose("flange", at, name="hand"), tasks.Posture(q, name="posture")]
    )
    derivative = problem.derivative(q)
    assert derivative.is_unique
    slope = np.linspace(-1, 1, 13)
    step = 1e-6
    by_v = [
        slope @ (body.integrate(q, step * unit) - body.integrate(q, -step * unit)) / (2 * step)
        for unit in np.eye(12)
    ]
    one = derivative.gradient(by_q=slope)["targets"]["hand"]
    other = derivative.gradient(by_v)["targets"]["hand"]
    np.testing.assert_allclose(one, other, atol=1e-8)


@pytest.mark.parametrize("length", [1.0, 2.5])
def test_posture_gradients_are_by_configuration(length):
    """Quaternions of any length included: equal to finite differences."""
    body = kinopt.Robot.from_urdf(MODELS / "universal_ur5e.urdf", base_joint="free")
    posture = np.concatenate([[0.1, 0.2, 0.3], [0.8, 0.2, -0.4, 0.4], START])
    posture[3:7] *= length / np.linalg.norm(posture[3:7])
    point = kinopt.frame_placement(body, "flange", posture)[:3, 3] + [0.05, -0.02, 0.03]
    problem = kinopt.Problem(
        body,
        [tasks.Point("flange", point, name="hand"), tasks.Posture(posture, name="rest", role="goal")],
    )
    solver = kinopt.Solver(gradient_tolerance=1e-13, step_tolerance=1e-13)
    question, _ = _solving.make_query(problem, {"rest": posture}, solver, "raise")
    start = body.normalise(posture)
    slope = np.linspace(-1, 1, 13)

    def scalar(rest):
        return slope @ _solving.solve(question, [rest], start)

    q = _solving.solve(question, [posture], start)
    (gradient,) = _solving.pull(question, [posture], start, q, slope)
    assert gradient.shape == (13,)
    step = 1e-4
    shown = [
        (scalar(posture + step * unit) - scalar(posture - step * unit)) / (2 * step)
        for unit in np.eye(13)
    ]
    np.testing.assert_allclose(gradient, shown, atol=5e-6)
    assert abs(gradient[3:7] @ posture[3:7]) < 1e-12


def pose(module, base, twist):
    """A pose from six numbers, by a module's own matrices."""
    x, y, z = twist[3], twist[4], twist[5]
    zero = 0 * x
    rows = [[zero, -z, y, twist[0]], [z, zero, -x, twist[1]], [-y, x, zero, twist[2]], [zero] * 4]
    stacked = module.stack([module.stack(row) for row in rows])
    exponential = module.linalg.matrix_exp if hasattr(module.linalg, "matrix_exp") else None
    if exponential is None:
        from jax.scipy.linalg import expm as exponential
    return base @ exponential(stacked)


def weighed(robot, target):
    """A pose traded against a posture, so that the solution depends on weights and lengths."""
    stated_tasks = [tasks.Pose("flange", target, name="hand"), tasks.Posture(START, name="rest", weight=0.3)]
    solver = kinopt.Solver(gradient_tolerance=1e-13, attempts=1, max_iterations=500)
    return kinopt.Problem(robot, stated_tasks, preferences="traded"), solver


def test_weights_and_origins_are_replaced(robot, targets):
    problem, solver = weighed(robot, targets[0])
    weights = problem.weights
    assert weights.shape == (len(problem.derivative(START).gradient(np.ones(6))["weights"]),) == (3,)
    heavier = problem.with_weights([2.0, 0.5, 0.1])
    stated = [
        tasks.Pose("flange", targets[0], name="hand", weight={"metres": 2.0, "radians": 0.5}),
        tasks.Posture(START, name="rest", weight=0.1),
    ]
    expected_problem = kinopt.Problem(robot, stated, preferences="traded")
    np.testing.assert_array_equal(solver.solve(heavier, START).q, solver.solve(expected_problem, START).q)
    np.testing.assert_array_equal(pickle.loads(pickle.dumps(heavier)).weights, [2.0, 0.5, 0.1])
    longer = problem.with_joint_origins({"joint2": (0.0, 0.0, 0.5)})
    longer = longer.with_joint_origins({"joint3": (0.1, 0.0, 0.4)})
    again = kinopt.Problem(
        robot,
        problem.tasks,
        preferences="traded",
        joint_origins={"joint2": (0.0, 0.0, 0.5), "joint3": (0.1, 0.0, 0.4)},
    )
    np.testing.assert_array_equal(longer.residual(START), again.residual(START))
    assert abs(longer.residual(START) - problem.residual(START)).max() > 0.01
    with pytest.raises(kinopt.InvalidValueError, match="2 weights are given, the problem has 3"):
        problem.with_weights([1.0, 1.0])
    with pytest.raises(kinopt.UnknownNameError, match="joint7"):
        problem.with_joint_origins({"joint7": (0.0, 0.0, 0.0)})
    with pytest.raises(kinopt.InvalidValueError, match="not finite|rigid"):
        problem.with_joint_origins({"joint2": (0.0, np.nan, 0.0)})


class TestTorch:
    torch = staticmethod(
        lambda: pytest.importorskip(
            "torch", reason="SKIPPED LOUDLY: PyTorch is not installed: pip install 'kinopt[torch]'"
        )
    )

    def test_gradients_of_arm_match_differences(self, arm, targets):
        torch = self.torch()
        import kinopt.torch

        bases = torch.as_tensor(targets[:2])

        def q(twists):
            made = torch.stack([pose(torch, bases[k], twists[k]) for k in range(2)])
            return kinopt.torch.solve(arm, made, START)

        twists = torch.zeros(2, 6, dtype=torch.float64, requires_grad=True)
        assert torch.autograd.gradcheck(q, twists, eps=1e-5, atol=1e-5)

    def test_gradients_of_problem_match_differences(self, robot, targets):
        torch = self.torch()
        import kinopt.torch

        problem = kinopt.Problem(
            robot,
            [tasks.Pose("flange", targets[0], name="hand"), tasks.Posture(START, name="rest")],
            preferences="traded",
        )
        solver = kinopt.Solver(gradient_tolerance=1e-13, attempts=1, max_iterations=500)
        base = torch.as_tensor(targets[0])

        def q(twist, rest):
            inputs = {"hand": pose(torch, base, twist), "rest": rest}
            return kinopt.torch.solve(problem, inputs, START, solver=solver)

        twist = torch.zeros(6, dtype=torch.float64, requires_grad=True)
        rest = torch.tensor(START, dtype=torch.float64, requires_grad=True)
        assert torch.autograd.gradcheck(q, (twist, rest), eps=1e-4, atol=1e-5)

    def test_gradients_by_weights_match_differences(self, robot, targets):
        torch = self.torch()
        import kinopt.torch

        problem, solver = weighed(robot, targets[0])

        def q(weights, elbow):
            origins = {"joint3": elbow}
            return kinopt.torch.solve(
                problem, {}, START, weights=weights, joint_origins=origins, solver=solver
            )

        weights = torch.tensor([[1.0, 0.3, 0.4], [0.8, 0.5, 0.2]], dtype=torch.float64, requires_grad=True)
        elbow = torch.tensor([0.02, 0.01, 0.45], dtype=torch.float64, requires_grad=True)
        assert q(weights, elbow).shape == (2, 6)
        assert torch.autograd.gradcheck(q, (weights, elbow), eps=1e-4, atol=1e-5)

    def test_batches_broadcast_and_keep_their_type(self, arm, targets):
        torch = self.torch()
        import kinopt.torch

        made = torch.as_tensor(targets, dtype=torch.float32).requires_grad_()
        q = kinopt.torch.solve(arm, made.reshape(5, 1, 4, 4), np.tile(START, (1, 2, 1)))
        assert q.shape == (5, 2, 6) and q.dtype == torch.float32
        q.sum().backward()
        assert made.grad.shape == (5, 4, 4) and bool(torch.isfinite(made.grad).all())

    def test_unsupported_parameters_raise(self, robot):
        torch = self.torch()
        import kinopt.torch

        floor = tasks.Plane("flange", [0, 0, 0.3], [0, 0, 1], name="floor")
        problem = kinopt.Problem(robot, [floor, tasks.LimitCentring(name="middle")])
        plane = torch.zeros(2, 3, dtype=torch.float64)
        with pytest.raises(kinopt.InvalidValueError, match="plane"):
            kinopt.torch.solve(problem, {"floor": plane}, START)
        with pytest.raises(kinopt.InvalidValueError, match="a dict by task"):
            kinopt.torch.solve(problem, plane, START)
        with pytest.raises(kinopt.UnknownNameError):
            kinopt.torch.solve(problem, {"flor": plane}, START)

    def test_missing_derivative_gives_chosen_gradient(self, robot):
        torch = self.torch()
        import kinopt.torch

        problem = kinopt.Problem(
            robot, [tasks.Posture(START, name="rest")], bounds={"joint1": (-1.0, START[0])}
        )
        rest = torch.tensor(START, dtype=torch.float64, requires_grad=True)
        for missing, is_expected in (("nan", np.isnan), ("zero", lambda grad: grad == 0.0)):
            q = kinopt.torch.solve(problem, {"rest": rest}, START, missing=missing)
            (grad,) = torch.autograd.grad(q.sum(), rest)
            assert is_expected(grad.numpy()).all()
        q = kinopt.torch.solve(problem, {"rest": rest}, START, missing="raise")
        with pytest.raises(kinopt.torch.NoDerivativeError, match="on_limit"):
            q.sum().backward()


class TestJax:
    @pytest.fixture(autouse=True)
    def digits(self):
        jax = pytest.importorskip(
            "jax", reason="SKIPPED LOUDLY: JAX is not installed: pip install 'kinopt[jax]'"
        )
        jax.config.update("jax_enable_x64", True)
        return jax

    def test_gradients_of_arm_match_differences(self, digits, arm, targets):
        jax, jnp = digits, digits.numpy
        import kinopt.jax

        def cost(twist):
            made = pose(jnp, jnp.asarray(targets[0]), twist)
            return (kinopt.jax.solve(arm, made, START) * jnp.arange(6.0)).sum()

        gradient = jax.jit(jax.grad(cost))(jnp.zeros(6))
        step = 1e-5
        shown = [(cost(step * unit) - cost(-step * unit)) / (2 * step) for unit in jnp.eye(6)]
        np.testing.assert_allclose(gradient, shown, atol=1e-5)

    def test_vmap_and_leading_axes_agree(self, digits, arm, targets):
        jax, jnp = digits, digits.numpy
        import kinopt.jax

        def cost(target):
            return (kinopt.jax.solve(arm, target, START) ** 2).sum()

        mapped = jax.vmap(jax.grad(cost))(jnp.asarray(targets))
        summed = jax.grad(cost)(jnp.asarray(targets))
        np.testing.assert_allclose(mapped, summed, atol=1e-12)

    def test_problem_accepts_a_dict(self, digits, problem):
        jax, jnp = digits, digits.numpy
        import kinopt.jax

        def cost(inputs):
            return kinopt.jax.solve(problem, inputs, START).sum()

        inputs = {"hand": jnp.array([0.4, 0.3, 0.4]), "posture": jnp.asarray(START)}
        gradient = jax.grad(cost)(inputs)
        q = kinopt.Solver().solve(problem, START).q
        derivative = problem.derivative(q)
        np.testing.assert_allclose(gradient["hand"], np.ones(6) @ derivative.by_target("hand"), atol=1e-7)
        assert gradient["posture"].shape == (6,)

    def test_gradients_by_weights_match_differences(self, digits, robot, arm, targets):
        jax, jnp = digits, digits.numpy
        import kinopt.jax

        problem, solver = weighed(robot, targets[0])

        def cost(numbers):
            weights, origins = numbers[:3], {"joint3": numbers[3:]}
            q = kinopt.jax.solve(
                problem, {}, START, weights=weights, joint_origins=origins, solver=solver
            )
            return (q * jnp.arange(1.0, 7.0)).sum()

        at = jnp.array([[1.0, 0.3, 0.4, 0.02, 0.01, 0.45], [0.8, 0.5, 0.2, 0.0, 0.0, 0.4]])
        gradients = jax.vmap(jax.grad(cost))(at)
        step = 1e-4
        for numbers, slopes in zip(at, gradients, strict=True):
            shown = [
                (cost(numbers + step * unit) - cost(numbers - step * unit)) / (2 * step)
                for unit in jnp.eye(6)
            ]
            np.testing.assert_allclose(slopes, shown, atol=2e-5)
            assert abs(slopes).min() > 1e-6
        with pytest.raises(kinopt.InvalidValueError, match="weights and joint_origins apply to problems only"):
            kinopt.jax.solve(arm, targets[0], START, weights=at[0, :3])

    def test_solve_outside_jit_compiles_once(self, digits, arm, robot, targets):
        import kinopt.jax

        problem = kinopt.Problem(robot, [tasks.Pose("flange", targets[0], name="hand")])

        def cost(target):
            return kinopt.jax.solve(arm, target, START).sum()

        def cost_of_problem(target):
            return kinopt.jax.solve(problem, {"hand": target}, START).sum()

        compiled = []
        digits.monitoring.register_event_duration_secs_listener(
            lambda event, *_, **__: compiled.append(event) if "backend_compile" in event else None
        )
        one, many = digits.numpy.asarray(targets[0]), digits.numpy.asarray(targets[:2])
        for function in (cost, cost_of_problem):
            calls = [(function, one), (digits.grad(function), one), (digits.vmap(digits.grad(function)), many)]
            for solve, given in calls:
                solve(given)
                before = len(compiled)
                for _ in range(3):
                    solve(given)
                assert len(compiled) == before

    def test_wrong_shapes_raise_invalid_value(self, digits, arm, robot, targets):
        import kinopt.jax

        problem = kinopt.Problem(robot, [tasks.Pose("flange", targets[0], name="hand")])
        for given, start in [
            (targets[0][:3], START),
            (targets[0], START[1:]),
            (targets[:2], np.tile(START, (3, 1))),
            (np.zeros((4, 4)), START),
        ]:
            with pytest.raises(kinopt.InvalidValueError):
                kinopt.jax.solve(arm, given, start)
            with pytest.raises(kinopt.InvalidValueError):
                kinopt.jax.solve(problem, {"hand": given}, start)
        with pytest.raises(kinopt.InvalidValueError):
            digits.jit(lambda target: kinopt.jax.solve(arm, target, START))(targets[0][:3])
