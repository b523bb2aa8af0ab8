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

/* Message of an error; empty without one. */
template <class Call> static std::string message_of(Call &&call) {
  try {
    call();
  } catch (const kinopt::Error &error) {
    return error.what();
  }
  return "";
}

static bool has(const std::string &text, const std::string &part) { return text.find(part) != std::string::npos; }

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
  const auto all = arm.solve_all(target, start);
  CHECK(all.solutions.size() > 1);
  for (const kinopt::Vector &q : all.solutions) CHECK(distance(arm.base_from_tool(q), target) < 1e-5);

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

  // A path through a box: each missed row has its reason, and the count in the error is that of missed rows and blocked
  // steps.
  kinopt::World wall;
  const Eigen::Vector3d middle = points[10].translation();
  kinopt::Placement block_pose = kinopt::Placement::Identity();
  block_pose.translation() = middle;
  wall.add_box("block", {0.3, 0.04, 0.3}, block_pose);
  const kinopt::Arm blocked_arm(robot, "base", "flange", model, wall);
  std::vector<kinopt::Placement> through;
  for (int k = 0; k <= 40; ++k) {
    through.push_back(points[10]);
    through.back().translation().y() += 0.01 * (k - 20);
  }
  const kinopt::JointPath collides(blocked_arm, through);
  CHECK(!collides.reached() && !collides.missed().empty());
  std::vector<bool> unreached(through.size());
  for (const kinopt::MissedPoint &missed : collides.missed()) {
    unreached[missed.row] = true;
    CHECK(has(missed.reason, "collision of") && has(missed.reason, "block"));
    CHECK(missed.position_error < 1e-6);
  }
  for (const kinopt::BlockedStep &step : collides.blocked()) {
    unreached[step.row] = true;
    CHECK(has(step.pair, "block"));
  }
  const auto accelerations = std::optional<kinopt::Vector>(kinopt::Vector::Constant(7, 2.0));
  const std::string message =
      message_of([&] { collides.trajectory(blocked_arm, std::nullopt, accelerations); });
  const auto unreached_rows = std::count(unreached.begin(), unreached.end(), true);
  CHECK(has(message, std::to_string(unreached_rows) + " of 41 rows") && has(message, "allow_unreached"));
  const kinopt::Trajectory allowed =
      collides.trajectory(blocked_arm, std::nullopt, accelerations, std::nullopt,
                          kinopt::Settings().set("allow_unreached", true).set("corner_tolerance", 1e-4));
  CHECK(allowed.duration() > 0.1);
  CHECK(has(message_of([&] {
              collides.trajectory(blocked_arm, std::nullopt, accelerations, std::nullopt,
                                  kinopt::Settings().set("corner_tolerance", -1.0));
            }),
            "corner_tolerance"));

  // A target in the block: the solution names the pair, and a servo that brakes before it too.
  kinopt::Solution inside = blocked_arm.solve(through[20], start);
  CHECK(!inside.reached() && !inside.collisions().empty());
  for (const kinopt::Collision &pair : inside.collisions()) CHECK(pair.first == "block" || pair.second == "block");
  kinopt::Solution beside = blocked_arm.solve(through[0], start);
  CHECK(beside.reached() && beside.collisions().empty());
  kinopt::Servo braking(blocked_arm, beside.q(), step,
                        kinopt::Settings().set("velocity_limits", limits).set("acceleration_limits", 10 * limits));
  KinoptServoStep braked = braking.step(through[0]);
  bool is_held = false;
  for (int k = 0; k < 3000 && braked.status != KINOPT_SERVO_STATUS_BLOCKED; ++k) {
    braked = braking.step(through[20]);
    for (size_t joint = 0; joint < 7; ++joint) is_held |= !braking.held_by(joint).empty();
  }
  CHECK(braked.status == KINOPT_SERVO_STATUS_BLOCKED && is_held);
  CHECK(!braking.collisions().empty());
  for (const kinopt::Collision &pair : braking.collisions()) CHECK(pair.first == "block" || pair.second == "block");
  CHECK(has(message_of([&] { braking.held_by(7); }), "7 joints"));

  // A mesh and points are obstacles; an attached one moves with its frame.
  kinopt::World shapes;
  const kinopt::Placement tip = arm.base_from_tool(start);
  Eigen::Matrix3Xd corners(3, 4);
  corners << -0.1, 0.1, 0.0, 0.0, -0.1, -0.1, 0.1, 0.0, 0.0, 0.0, 0.0, 0.1;
  Eigen::Matrix<uint32_t, 3, Eigen::Dynamic> faces(3, 4);
  faces << 0, 0, 1, 2, 2, 1, 2, 0, 1, 3, 3, 3;
  shapes.add_mesh("pyramid", corners, faces, tip);
  const kinopt::Arm near_mesh(robot, "base", "flange", model, shapes);
  CHECK(near_mesh.collides(start));
  shapes.remove("pyramid");
  CHECK(!near_mesh.with_world(shapes).collides(start));
  shapes.add_points("cloud", Eigen::Matrix3Xd(tip.translation()), 0.02);
  CHECK(near_mesh.with_world(shapes).collides(start));
  kinopt::Placement far = kinopt::Placement::Identity();
  far.translation() << 5.0, 0.0, 0.0;
  shapes.move("cloud", far);
  CHECK(!near_mesh.with_world(shapes).collides(start));
  shapes.attach("cloud", "base", kinopt::Placement::Identity());
  CHECK(near_mesh.with_world(shapes).collides(start));
  shapes.detach("cloud", far);
  CHECK(!near_mesh.with_world(shapes).collides(start));
  CHECK(has(message_of([&] { shapes.add_mesh("bad", corners, 9 * faces); }), "bad"));

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
  // Settings: messages name the option.
  using Values = std::vector<std::pair<std::string, double>>;
  const auto arm_with = [&](const kinopt::Settings &settings) {
    return message_of([&] { kinopt::Arm(robot, "base", "flange", settings); });
  };
  CHECK(has(arm_with(kinopt::Settings().set("position_tolerance", std::nan(""))), "position_tolerance"));
  CHECK(has(arm_with(kinopt::Settings().set("position_tolerance", INFINITY)), "position_tolerance"));
  CHECK(has(arm_with(kinopt::Settings().set("locked", Values{{"joint1", std::nan("")}})), "joint1"));
  CHECK(has(arm_with(kinopt::Settings().set("seed", 1).set("seed", 2)), "`seed` is given twice"));
  CHECK(has(arm_with(kinopt::Settings().set("held", "x")), "held"));
  CHECK(has(arm_with(kinopt::Settings().set("held", Values{{"nope", 1.0}})), "joint1"));
  CHECK(has(arm_with(kinopt::Settings().set("held", kinopt::Vector::Zero(2))), "expected"));
  CHECK(has(arm_with(kinopt::Settings().set("held", robot.neutral())), "needs `only`"));
  CHECK(has(arm_with(kinopt::Settings().set("margin", 0.01)), "kinopt_arm_new_in_world"));
  const std::string unknown = arm_with(kinopt::Settings().set("nothing", 1));
  CHECK(has(unknown, "goal, ") && has(unknown, "attempts") && has(unknown, "atlas"));
  kinopt::Vector one_free = limits;
  one_free[3] = INFINITY;
  kinopt::Servo unlimited(arm, start, step, kinopt::Settings().set("velocity_limits", one_free));
  CHECK(unlimited.step(target).status == KINOPT_SERVO_STATUS_SPEED_LIMITED);
  one_free[3] = std::nan("");
  CHECK(has(message_of([&] {
              kinopt::Servo(arm, start, step, kinopt::Settings().set("velocity_limits", one_free));
            }),
            "velocity_limits"));

  // A target that is not finite: the message has the entry, and no number of a query.
  kinopt::Placement broken = target;
  broken.translation().z() = std::nan("");
  CHECK(has(message_of([&] { arm.solve(broken, start); }), "target: the entry in row 2, column 3"));
  CHECK(has(message_of([&] { arm.solve_batch({target, broken}, start); }), "target 1: the entry in row 2, column 3"));
  CHECK(kinopt::Solution().explain() == "No query was solved yet.");

  // Moved-from objects are empty.
  kinopt::Arm moved(robot, "base", "flange", kinopt::Settings().set("atlas", false));
  const kinopt::Arm taken = std::move(moved);
  CHECK(moved.joint_count() == 0 && taken.joint_count() == 7);
  CHECK(status_of([&] { moved.solve(target, start); }) == KINOPT_STATUS_INVALID_VALUE);
  return failures;
}
