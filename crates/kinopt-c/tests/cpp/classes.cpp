// Promise: the C++ classes give the results of the C interface, and throw its errors.
#include <kinopt/kinopt.hpp>

#include <array>
#include <iostream>

static int failures = 0;

static void check(bool condition, const char *text, int line) {
  if (condition) return;
  ++failures;
  std::cout << "line " << line << ": " << text << "\n";
}
#define CHECK(condition) check((condition), #condition, __LINE__)

template <class Call> static KinoptStatus status_of(Call &&call) {
  try {
    call();
  } catch (const kinopt::Error &error) {
    return error.status();
  }
  return KINOPT_STATUS_OK;
}

static double distance(const kinopt::Placement &a, const kinopt::Placement &b) {
  return (a.matrix() - b.matrix()).cwiseAbs().maxCoeff();
}

int main(int count, char **arguments) {
  const std::string models = count > 1 ? arguments[1] : "models";
  const kinopt::Robot robot = kinopt::Robot::read(models + "/franka_panda.urdf");
  const kinopt::Arm arm(robot, "base", "flange", kinopt::Settings().set("position_tolerance", 1e-7));
  const kinopt::Vector start = arm.default_start();
  kinopt::Placement target = arm.base_from_tool(start);
  target.translation().y() += 0.1;

  kinopt::Solution solution = arm.solve(target, start);
  CHECK(solution.reached());
  CHECK(distance(arm.base_from_tool(solution.q()), target) < 1e-6);
  CHECK(solution.explain().rfind("Reached", 0) == 0);
  const auto [lower, upper] = arm.limits();
  CHECK((solution.q().array() >= lower.array()).all() && (solution.q().array() <= upper.array()).all());

  // A tool, a batch and several solutions.
  kinopt::Placement tool = kinopt::Placement::Identity();
  tool.translation().z() = 0.1;
  CHECK(distance(arm.with_tool(tool).base_from_tool(start), arm.base_from_tool(start) * tool) < 1e-12);
  const kinopt::Batch batch = arm.solve_batch({target, arm.base_from_tool(start)}, start);
  CHECK(batch.outcomes[0].reached && batch.outcomes[1].reached);
  CHECK(batch.q.row(0).transpose() == solution.q());
  const auto distinct = arm.solve_distinct(target, start, 8);
  CHECK(distinct.size() > 1);
  for (const kinopt::Vector &q : distinct) CHECK(distance(arm.base_from_tool(q), target) < 1e-5);

  // An exception of a callback passes through the library's caller.
  bool thrown = false;
  try {
    arm.solve_accepted(target, start, [](const auto &) -> bool { throw std::runtime_error("own"); }, solution);
  } catch (const std::runtime_error &error) {
    thrown = std::string(error.what()) == "own";
  }
  CHECK(thrown);

  // Links of the arm: the tip moves as the arm, the elbow by the first joints, the base not at all.
  kinopt::Jacobian whole(arm);
  Eigen::Matrix<double, 6, Eigen::Dynamic> columns;
  for (const char *name : {"base", "link4", "flange"}) {
    kinopt::ArmLink link(robot, "base", "flange", name);
    link.jacobian(start, columns);
    CHECK(columns.cols() == 7);
    for (Eigen::Index joint = 0; joint < 7; ++joint) {
      const double step = 1e-6;
      kinopt::Vector ahead = start, behind = start;
      ahead[joint] += step, behind[joint] -= step;
      const kinopt::Placement a = link.base_from_link(ahead), b = link.base_from_link(behind);
      const Eigen::Vector3d velocity = (a.translation() - b.translation()) / (2 * step);
      CHECK((velocity - columns.col(joint).head<3>()).norm() < 1e-8);
      const Eigen::AngleAxisd turn(a.linear() * b.linear().transpose());
      CHECK((turn.angle() * turn.axis() / (2 * step) - columns.col(joint).tail<3>()).norm() < 1e-8);
    }
  }
  CHECK(columns == whole.at(start));
  const kinopt::ArmLink root(robot, "base", "flange", "base");
  CHECK(distance(root.base_from_link(start), kinopt::Placement::Identity()) < 1e-15);
  CHECK(status_of([&] { kinopt::ArmLink(robot, "base", "link4", "flange"); }) == KINOPT_STATUS_INVALID_VALUE);
  CHECK(status_of([&] { kinopt::ArmLink(robot, "base", "flange", "elbow"); }) == KINOPT_STATUS_UNKNOWN_NAME);

  // A servo keeps its velocity limits on the way to a target.
  const double step = 1e-3;
  const kinopt::Vector limits = kinopt::Vector::Constant(7, 0.5);
  kinopt::Servo servo(arm, start, step,
                      kinopt::Settings().set("velocity_limits", limits).set("acceleration_limits", 10 * limits));
  kinopt::Vector before = servo.q();
  KinoptServoStep cycle{};
  for (int k = 0; k < 5000 && cycle.status != KINOPT_SERVO_STATUS_ON_TARGET; ++k) {
    cycle = servo.step(target);
    CHECK(((servo.q() - before).cwiseAbs().array() <= 0.5 * step * (1 + 1e-9)).all());
    before = servo.q();
    if (k == 0) cycle.status = KINOPT_SERVO_STATUS_SETTLING;
  }
  CHECK(cycle.status == KINOPT_SERVO_STATUS_ON_TARGET);

  // A path among obstacles: every row is free of collisions.
  kinopt::World world;
  kinopt::Placement pose = kinopt::Placement::Identity();
  pose.translation() << target.translation().x(), target.translation().y(), 0.05;
  world.add_box("table", {0.4, 0.4, 0.1}, pose);
  const kinopt::CollisionModel model(robot);
  const kinopt::Arm safe(robot, "base", "flange", model, world, 0.005);
  std::vector<kinopt::Placement> points;
  for (int k = 0; k <= 20; ++k) {
    points.push_back(arm.base_from_tool(start));
    points.back().translation().y() += 0.005 * k;
  }
  const kinopt::JointPath path(safe, points);
  CHECK(path.reached() && path.q().rows() == 21 && path.jumps().empty());
  for (Eigen::Index row = 0; row < path.q().rows(); ++row) CHECK(!safe.collides(path.q().row(row).transpose()));
  kinopt::Trajectory trajectory = path.trajectory(safe, std::nullopt, kinopt::Vector(kinopt::Vector::Constant(7, 2.0)));
  CHECK(trajectory.duration() > 0.1 && trajectory.at(0.0).velocity.isZero());
  CHECK((trajectory.at(trajectory.duration()).q - path.q().row(20).transpose()).cwiseAbs().maxCoeff() < 1e-4);

  // A problem of the whole robot, with a target that moves.
  const kinopt::Problem problem(
      robot, R"([{"kind": "point", "frame": "flange", "name": "tip", "target": [0.4, 0.1, 0.5]}])");
  kinopt::Targets targets(problem);
  targets.set("tip", kinopt::Vector(Eigen::Vector3d(0.5, 0.0, 0.4)));
  kinopt::Solver solver;
  solver.solve(problem, &targets, robot.neutral(), solution);
  CHECK(solution.reached() && problem.task_names() == std::vector<std::string>{"tip"});
  const kinopt::Vector q = solution.q().head(7);
  CHECK((arm.base_from_tool(q).translation() - Eigen::Vector3d(0.5, 0.0, 0.4)).norm() < 1e-5);

  // Errors have a status.
  CHECK(status_of([&] { kinopt::Arm(robot, "base", "nowhere"); }) == KINOPT_STATUS_UNKNOWN_NAME);
  CHECK(status_of([&] { kinopt::Arm(robot, "base", "flange", kinopt::Settings().set("nothing", 1)); }) ==
        KINOPT_STATUS_UNKNOWN_NAME);
  CHECK(status_of([&] { arm.solve(target, kinopt::Vector::Zero(3)); }) == KINOPT_STATUS_INVALID_VALUE);
  CHECK(status_of([&] { targets.set("tip", kinopt::Placement::Identity()); }) == KINOPT_STATUS_INVALID_VALUE);
  CHECK(status_of([&] { kinopt::Robot::read(models + "/nothing.urdf"); }) == KINOPT_STATUS_FILE);
  return failures;
}
