// C++17 layer over kinopt.h, with Eigen. Licence: MIT or Apache-2.0.
//
// Classes own their objects and can be moved. A moved-from object is empty: its functions throw kinopt::Error, or return
// 0, false or no names. Errors of the library are exceptions of type kinopt::Error. A target that is not reached is no
// error. Units are metres, radians and seconds. The threads of each class are those of kinopt.h.
#ifndef KINOPT_HPP
#define KINOPT_HPP

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "kinopt.h"

namespace kinopt {

using Vector = Eigen::VectorXd;
using VectorRef = Eigen::Ref<const Eigen::VectorXd>;
using Placement = Eigen::Isometry3d;

/// Error of the library, with its status.
class Error : public std::runtime_error {
public:
  Error(KinoptStatus status, const std::string &message) : std::runtime_error(message), status_(status) {}
  KinoptStatus status() const { return status_; }

private:
  KinoptStatus status_;
};

namespace detail {

inline void check(KinoptStatus status) {
  if (status != KINOPT_STATUS_OK) throw Error(status, kinopt_error_message());
}

/// Owner of an object of the C interface.
template <class T, void (*Free)(T *)> struct Deleter {
  void operator()(T *object) const { Free(object); }
};
template <class T, void (*Free)(T *)> using Owner = std::unique_ptr<T, Deleter<T, Free>>;

inline size_t size(Eigen::Index length) { return static_cast<size_t>(length); }
inline Eigen::Index index(size_t length) { return static_cast<Eigen::Index>(length); }

/// Text that a function of the C interface writes: called for its length, then for the text.
template <class Write> std::string text(Write &&write) {
  size_t length = 0;
  check(write(nullptr, 0, &length));
  std::string text(length + 1, '\0');
  check(write(text.data(), text.size(), nullptr));
  text.resize(length);
  return text;
}

/// Sixteen numbers of each placement, one after another.
inline std::vector<double> numbers(const std::vector<Placement> &placements) {
  std::vector<double> all;
  all.reserve(16 * placements.size());
  for (const Placement &placement : placements) all.insert(all.end(), placement.data(), placement.data() + 16);
  return all;
}

} // namespace detail

/// Options by name, as text of a JSON object. Numbers may be infinite where the option allows it, such as a velocity limit
/// of one joint. An option that is set twice is an error of the call that gets the settings.
class Settings {
public:
  Settings() = default;
  Settings &set(const std::string &name, double value) { return add(name, number(value)); }
  Settings &set(const std::string &name, bool value) { return add(name, value ? "true" : "false"); }
  Settings &set(const std::string &name, int value) { return add(name, std::to_string(value)); }
  Settings &set(const std::string &name, const char *value) { return add(name, quoted(value)); }
  Settings &set(const std::string &name, const std::string &value) { return add(name, quoted(value)); }
  Settings &set(const std::string &name, const VectorRef &values) { return add(name, list(values)); }
  /// Values by name, such as locked joints.
  Settings &set(const std::string &name, const std::vector<std::pair<std::string, double>> &values) {
    std::string all;
    for (const auto &[key, value] : values) all += (all.empty() ? "" : ", ") + quoted(key) + ": " + number(value);
    return add(name, "{" + all + "}");
  }
  Settings &set(const std::string &name, const std::vector<std::string> &names) {
    std::string all;
    for (const std::string &each : names) all += (all.empty() ? "" : ", ") + quoted(each);
    return add(name, "[" + all + "]");
  }
  Settings &set(const std::string &name, const Placement &placement) {
    std::string rows;
    for (int row = 0; row < 4; ++row) {
      rows += (row == 0 ? "" : ", ") + list(Eigen::VectorXd(placement.matrix().row(row).transpose()));
    }
    return add(name, "[" + rows + "]");
  }
  /// JSON object.
  std::string json() const { return "{" + members_ + "}"; }

private:
  Settings &add(const std::string &name, const std::string &value) {
    members_ += (members_.empty() ? "" : ", ") + quoted(name) + ": " + value;
    return *this;
  }
  static std::string number(double value) {
    if (std::isinf(value)) return value > 0 ? "\"inf\"" : "\"-inf\"";
    // No number for the library, whose error names the option.
    if (std::isnan(value)) return "\"nan\"";
    char text[32];
    std::snprintf(text, sizeof text, "%.17g", value);
    return text;
  }
  static std::string list(const VectorRef &values) {
    std::string all;
    for (double value : values) all += (all.empty() ? "" : ", ") + number(value);
    return "[" + all + "]";
  }
  static std::string quoted(const std::string &text) {
    std::string all = "\"";
    for (char each : text) {
      if (each == '"' || each == '\\') all += '\\';
      if (static_cast<unsigned char>(each) < 0x20) {
        char code[8];
        std::snprintf(code, sizeof code, "\\u%04x", each);
        all += code;
      } else {
        all += each;
      }
    }
    return all + "\"";
  }

  std::string members_;
};

/// Robot: joints, links, limits.
class Robot {
public:
  /// Reads a URDF or MJCF file.
  static Robot read(const std::string &path, const Settings &settings = {}) {
    KinoptRobot *robot = nullptr;
    detail::check(kinopt_robot_read(path.c_str(), settings.json().c_str(), &robot));
    return Robot(robot);
  }
  /// Reads the text of a URDF or MJCF file; `name` is the file's name in messages.
  static Robot parse(const std::string &text, const std::string &name, const Settings &settings = {}) {
    KinoptRobot *robot = nullptr;
    detail::check(kinopt_robot_parse(text.c_str(), name.c_str(), settings.json().c_str(), &robot));
    return Robot(robot);
  }
  /// Robot with the joint limits of the text of a MoveIt joint_limits.yaml.
  Robot with_joint_limits(const std::string &yaml, const std::string &file) const {
    KinoptRobot *robot = nullptr;
    detail::check(kinopt_robot_with_joint_limits(get(), yaml.c_str(), file.c_str(), &robot));
    return Robot(robot);
  }
  Vector neutral() const {
    Vector q(detail::index(kinopt_robot_configuration_len(get())));
    detail::check(kinopt_robot_neutral(get(), q.data(), detail::size(q.size())));
    return q;
  }
  std::vector<std::string> frame_names() const {
    std::vector<std::string> names;
    for (size_t k = 0; k < kinopt_robot_frame_count(get()); ++k) names.emplace_back(kinopt_robot_frame_name(get(), k));
    return names;
  }
  const KinoptRobot *get() const { return owner_.get(); }

private:
  explicit Robot(KinoptRobot *robot) : owner_(robot) {}
  detail::Owner<KinoptRobot, kinopt_robot_free> owner_;
};

/// Obstacles by name.
class World {
public:
  World() {
    KinoptWorld *world = nullptr;
    detail::check(kinopt_world_new(&world));
    owner_.reset(world);
  }
  static World read(const std::string &path) {
    KinoptWorld *world = nullptr;
    detail::check(kinopt_world_read(path.c_str(), &world));
    World read;
    read.owner_.reset(world);
    return read;
  }
  /// Box by its full lengths along x, y and z.
  void add_box(const std::string &name, const Eigen::Vector3d &size, const Placement &pose = Placement::Identity()) {
    detail::check(kinopt_world_add_box(get(), name.c_str(), size.data(), pose.data()));
  }
  void add_sphere(const std::string &name, double radius, const Placement &pose = Placement::Identity()) {
    detail::check(kinopt_world_add_sphere(get(), name.c_str(), radius, pose.data()));
  }
  /// Cylinder along z.
  void add_cylinder(const std::string &name, double radius, double length,
                    const Placement &pose = Placement::Identity()) {
    detail::check(kinopt_world_add_cylinder(get(), name.c_str(), radius, length, pose.data()));
  }
  /// Capsule along z; `length` is that of its segment.
  void add_capsule(const std::string &name, double radius, double length,
                   const Placement &pose = Placement::Identity()) {
    detail::check(kinopt_world_add_capsule(get(), name.c_str(), radius, length, pose.data()));
  }
  /// Half-space below z = 0 of the pose.
  void add_plane(const std::string &name, const Placement &pose = Placement::Identity()) {
    detail::check(kinopt_world_add_plane(get(), name.c_str(), pose.data()));
  }
  /// Triangle mesh: vertices are columns, triangles are columns of three indices of vertices.
  void add_mesh(const std::string &name, const Eigen::Matrix3Xd &vertices,
                const Eigen::Matrix<uint32_t, 3, Eigen::Dynamic> &triangles,
                const Placement &pose = Placement::Identity()) {
    detail::check(kinopt_world_add_mesh(get(), name.c_str(), vertices.data(), detail::size(vertices.cols()),
                                        triangles.data(), detail::size(triangles.cols()), pose.data()));
  }
  /// Spheres of one radius about points, which are columns.
  void add_points(const std::string &name, const Eigen::Matrix3Xd &positions, double radius,
                  const Placement &pose = Placement::Identity()) {
    detail::check(kinopt_world_add_points(get(), name.c_str(), positions.data(), detail::size(positions.cols()), radius,
                                          pose.data()));
  }
  /// Attaches an obstacle to a frame of the robot, such as a grasped object to the tool.
  void attach(const std::string &name, const std::string &frame, const Placement &frame_from_object) {
    detail::check(kinopt_world_attach(get(), name.c_str(), frame.c_str(), frame_from_object.data()));
  }
  /// Detaches an obstacle from its frame.
  void detach(const std::string &name, const Placement &world_from_object) {
    detail::check(kinopt_world_detach(get(), name.c_str(), world_from_object.data()));
  }
  void move(const std::string &name, const Placement &pose) {
    detail::check(kinopt_world_move(get(), name.c_str(), pose.data()));
  }
  void remove(const std::string &name) { detail::check(kinopt_world_remove(get(), name.c_str())); }
  void allow_collision(const std::string &one, const std::string &other) {
    detail::check(kinopt_world_allow_collision(get(), one.c_str(), other.c_str()));
  }
  KinoptWorld *get() { return owner_.get(); }
  const KinoptWorld *get() const { return owner_.get(); }

private:
  detail::Owner<KinoptWorld, kinopt_world_free> owner_;
};

/// Collision shapes of a robot and its enabled collision pairs.
class CollisionModel {
public:
  explicit CollisionModel(const Robot &robot) {
    KinoptCollisionModel *model = nullptr;
    detail::check(kinopt_collision_model_new(robot.get(), &model));
    owner_.reset(model);
  }
  const KinoptCollisionModel *get() const { return owner_.get(); }

private:
  detail::Owner<KinoptCollisionModel, kinopt_collision_model_free> owner_;
};

/// Pair in collision, or nearer than the margin.
struct Collision {
  /// Names of links or obstacles.
  std::string first, second;
  /// Metres, negative for penetration.
  double distance = 0.0;
};

namespace detail {

/// Pairs of a function as kinopt_solution_collision.
template <class T, class Read> std::vector<Collision> collisions(const T *object, size_t count, Read read) {
  std::vector<Collision> all;
  // Longer names are shortened.
  std::vector<char> first(1024), second(first.size());
  for (size_t k = 0; k < count; ++k) {
    double distance = 0.0;
    check(read(object, k, first.data(), second.data(), first.size(), &distance));
    all.push_back({first.data(), second.data(), distance});
  }
  return all;
}

} // namespace detail

/// Result of a query, reached or not.
class Solution {
public:
  Solution() {
    KinoptSolution *solution = nullptr;
    detail::check(kinopt_solution_new(&solution));
    owner_.reset(solution);
  }
  bool reached() const { return kinopt_solution_reached(get()); }
  /// Configuration, valid until the next query with this solution.
  Eigen::Map<const Vector> q() const {
    size_t length = 0;
    const double *q = kinopt_solution_q(get(), &length);
    return {q, detail::index(length)};
  }
  KinoptOutcome outcome() const {
    KinoptOutcome outcome;
    detail::check(kinopt_solution_outcome(get(), &outcome));
    return outcome;
  }
  /// Errors, and the limits or collisions that prevent a better result.
  std::string explain() const {
    return detail::text([this](char *buffer, size_t size, size_t *length) {
      return kinopt_solution_explain(get(), buffer, size, length);
    });
  }
  /// Pairs in collision, or nearer than the margin.
  std::vector<Collision> collisions() const {
    return detail::collisions(get(), collision_count(), kinopt_solution_collision);
  }
  size_t collision_count() const { return kinopt_solution_collision_count(get()); }
  KinoptSolution *get() { return owner_.get(); }
  const KinoptSolution *get() const { return owner_.get(); }

private:
  detail::Owner<KinoptSolution, kinopt_solution_free> owner_;
};

/// Solutions of a target.
struct AllSolutions {
  /// Configurations, nearest to the start first.
  std::vector<Vector> solutions;
  /// True if there are no other isolated solutions.
  bool complete;
};

/// Configurations, one a row, and errors of a batch.
struct Batch {
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> q;
  std::vector<KinoptOutcome> outcomes;
};

/// Arm: the joints from a base to a tip of a robot, prepared for queries.
class Arm {
public:
  /// Arm from the frame `base` (empty for the world) to the frame `tip`.
  Arm(const Robot &robot, const std::string &base, const std::string &tip, const Settings &settings = {}) {
    KinoptArm *arm = nullptr;
    detail::check(kinopt_arm_new(robot.get(), name(base), tip.c_str(), settings.json().c_str(), &arm));
    owner_.reset(arm);
  }
  /// Arm that avoids collisions with itself and a world, by at least `margin` metres. `held` has the positions of the
  /// joints outside the arm.
  Arm(const Robot &robot, const std::string &base, const std::string &tip, const CollisionModel &model,
      const World &world, double margin = 0.0, const Settings &settings = {},
      const std::optional<Vector> &held = std::nullopt) {
    KinoptArm *arm = nullptr;
    detail::check(kinopt_arm_new_in_world(robot.get(), name(base), tip.c_str(), model.get(), world.get(), margin,
                                          held ? held->data() : nullptr, held ? detail::size(held->size()) : 0,
                                          settings.json().c_str(), &arm));
    owner_.reset(arm);
  }
  Arm with_world(const World &world, double margin = 0.0) const {
    KinoptArm *arm = nullptr;
    detail::check(kinopt_arm_with_world(get(), world.get(), margin, &arm));
    return Arm(arm);
  }
  Arm with_tool(const Placement &tip_from_tool) const {
    KinoptArm *arm = nullptr;
    detail::check(kinopt_arm_with_tool(get(), tip_from_tool.data(), &arm));
    return Arm(arm);
  }
  /// Arm with other bounds of a query: seconds, and the largest motion of each joint from the start.
  Arm with_bounds(double time_limit, const std::optional<Vector> &max_move = std::nullopt) const {
    KinoptArm *arm = nullptr;
    detail::check(kinopt_arm_with_bounds(get(), time_limit, max_move ? max_move->data() : nullptr,
                                         max_move ? detail::size(max_move->size()) : 0, &arm));
    return Arm(arm);
  }
  size_t joint_count() const { return kinopt_arm_joint_count(get()); }
  std::vector<std::string> joint_names() const {
    std::vector<std::string> names;
    for (size_t k = 0; k < joint_count(); ++k) names.emplace_back(kinopt_arm_joint_name(get(), k));
    return names;
  }
  /// Lower and upper position limits.
  std::pair<Vector, Vector> limits() const {
    Vector lower(detail::index(joint_count())), upper(lower.size());
    detail::check(kinopt_arm_limits(get(), lower.data(), upper.data(), joint_count()));
    return {lower, upper};
  }
  Vector default_start() const {
    Vector q(detail::index(joint_count()));
    detail::check(kinopt_arm_default_start(get(), q.data(), joint_count()));
    return q;
  }
  Placement base_from_tool(const VectorRef &q) const {
    Placement placement;
    detail::check(kinopt_arm_base_from_tool(get(), q.data(), detail::size(q.size()), placement.data()));
    return placement;
  }
  bool collides(const VectorRef &q) const {
    bool collides = false;
    detail::check(kinopt_arm_collides(get(), q.data(), detail::size(q.size()), &collides));
    return collides;
  }
  /// Solves into an existing solution, which avoids allocations.
  void solve(const Placement &target, const VectorRef &start, Solution &solution) const {
    detail::check(kinopt_arm_solve(get(), target.data(), start.data(), detail::size(start.size()), solution.get()));
  }
  Solution solve(const Placement &target, const VectorRef &start) const {
    Solution solution;
    solve(target, start, solution);
    return solution;
  }
  /// Offers reached configurations to `accept` until it returns true. Returns whether one was accepted.
  ///
  /// An arm with a time limit searches until it ends, or until further attempts lead to no new solution. An exception of
  /// `accept` ends the search and is thrown again.
  bool solve_accepted(const Placement &target, const VectorRef &start,
                      const std::function<bool(Eigen::Map<const Vector>)> &accept, Solution &solution) const {
    struct Call {
      const std::function<bool(Eigen::Map<const Vector>)> &accept;
      std::exception_ptr thrown;
    } call{accept, nullptr};
    const auto forward = [](const double *q, size_t length, void *data) {
      Call &call = *static_cast<Call *>(data);
      if (call.thrown) return true;
      try {
        return call.accept(Eigen::Map<const Vector>(q, detail::index(length)));
      } catch (...) {
        call.thrown = std::current_exception();
        return true;
      }
    };
    bool accepted = false;
    detail::check(kinopt_arm_solve_accepted(get(), target.data(), start.data(), detail::size(start.size()), forward,
                                            &call, solution.get(), &accepted));
    if (call.thrown) std::rethrow_exception(call.thrown);
    return accepted;
  }
  /// All solutions, nearest to the start first.
  AllSolutions solve_all(const Placement &target, const VectorRef &start) const {
    size_t count = 64;
    std::vector<double> q;
    bool complete = false;
    // A second call, if there are more solutions than the first has room for.
    for (size_t capacity = 0; capacity < count;) {
      capacity = count;
      q.resize(capacity * joint_count());
      detail::check(kinopt_arm_solve_all(get(), target.data(), start.data(), detail::size(start.size()), q.data(),
                                         capacity, &count, &complete));
    }
    AllSolutions all{{}, complete};
    for (size_t row = 0; row < count; ++row) {
      all.solutions.emplace_back(
          Eigen::Map<const Vector>(q.data() + row * joint_count(), detail::index(joint_count())));
    }
    return all;
  }
  /// Solves many targets from one start; `threads` 0 is all cores.
  Batch solve_batch(const std::vector<Placement> &targets, const VectorRef &start, size_t threads = 0) const {
    Batch batch{{detail::index(targets.size()), detail::index(joint_count())},
                std::vector<KinoptOutcome>(targets.size())};
    const std::vector<double> numbers = detail::numbers(targets);
    detail::check(kinopt_arm_solve_batch(get(), numbers.data(), targets.size(), start.data(),
                                         detail::size(start.size()), threads, batch.q.data(),
                                         detail::size(batch.q.size()), batch.outcomes.data(), targets.size()));
    return batch;
  }
  const KinoptArm *get() const { return owner_.get(); }

private:
  explicit Arm(KinoptArm *arm) : owner_(arm) {}
  static const char *name(const std::string &base) { return base.empty() ? nullptr : base.c_str(); }
  detail::Owner<KinoptArm, kinopt_arm_free> owner_;
};

/// Jacobian of an arm's tool: linear, then angular velocity in the base's axes.
class Jacobian {
public:
  explicit Jacobian(const Arm &arm) : columns_(detail::index(arm.joint_count())) {
    KinoptJacobian *jacobian = nullptr;
    detail::check(kinopt_jacobian_new(arm.get(), &jacobian));
    owner_.reset(jacobian);
  }
  Eigen::Matrix<double, 6, Eigen::Dynamic> at(const VectorRef &q) {
    Eigen::Matrix<double, 6, Eigen::Dynamic> matrix(6, columns_);
    at(q, matrix.data());
    return matrix;
  }
  /// Writes the matrix by columns to `matrix`, six numbers for each joint. Allocates nothing.
  void at(const VectorRef &q, double *matrix) {
    detail::check(
        kinopt_jacobian_at(owner_.get(), q.data(), detail::size(q.size()), matrix, 6 * detail::size(columns_)));
  }
  /// Number of joints.
  Eigen::Index columns() const { return columns_; }

private:
  Eigen::Index columns_;
  detail::Owner<KinoptJacobian, kinopt_jacobian_free> owner_;
};

/// A link between base and tip of an arm, such as the elbow: its placement and Jacobian in the arm's base.
class ArmLink {
public:
  /// `base` is empty for the world. Throws an error for a link that is not between base and tip.
  ArmLink(const Robot &robot, const std::string &base, const std::string &tip, const std::string &link) {
    // Seeds are of no use here, and take time.
    const Settings settings = Settings().set("atlas", false);
    const Arm arm(robot, base, tip, settings);
    const std::vector<std::string> joints = arm.joint_names();
    joint_count_ = detail::index(joints.size());
    std::vector<std::string> moving;
    try {
      part_.emplace(robot, base, link, settings);
      jacobian_.emplace(*part_);
      moving = part_->joint_names();
    } catch (const Error &) {
      // No joint moves the link, or there is none of this name.
      const Arm rest(robot, link, tip, settings);
      if (rest.joint_names() != joints) throw;
      const Vector q = arm.default_start();
      fixed_ = arm.base_from_tool(q) * rest.base_from_tool(q).inverse();
    }
    if (moving.size() > joints.size() || !std::equal(moving.begin(), moving.end(), joints.begin())) {
      throw Error(KINOPT_STATUS_INVALID_VALUE,
                  "link `" + link + "` is not between base `" + base + "` and tip `" + tip + "`");
    }
  }
  /// Placement in the base at a configuration of the arm.
  Placement base_from_link(const VectorRef &q) const {
    check_length(q);
    return part_ ? part_->base_from_tool(q.head(detail::index(part_->joint_count()))) : fixed_;
  }
  /// Jacobian at a configuration of the arm: linear, then angular velocity in the base's axes.
  ///
  /// Joints beyond the link have columns of zeros. Allocates nothing if `matrix` has a column for each joint of the arm.
  void jacobian(const VectorRef &q, Eigen::Matrix<double, 6, Eigen::Dynamic> &matrix) {
    check_length(q);
    matrix.setZero(6, joint_count_);
    if (jacobian_) jacobian_->at(q.head(jacobian_->columns()), matrix.data());
  }

private:
  void check_length(const VectorRef &q) const {
    if (q.size() != joint_count_) {
      throw Error(KINOPT_STATUS_INVALID_VALUE,
                  "`q` has length " + std::to_string(q.size()) + ", expected " + std::to_string(joint_count_));
    }
  }

  Eigen::Index joint_count_ = 0;
  /// From the base to the link; none if no joint moves it.
  std::optional<Arm> part_;
  std::optional<Jacobian> jacobian_;
  Placement fixed_ = Placement::Identity();
};

/// One joint command in each control cycle, within motion limits.
class Servo {
public:
  Servo(const Arm &arm, const VectorRef &start, double time_step, const Settings &settings = {}) : q_(start) {
    KinoptServo *servo = nullptr;
    detail::check(kinopt_servo_new(arm.get(), start.data(), detail::size(start.size()), time_step,
                                   settings.json().c_str(), &servo));
    owner_.reset(servo);
  }
  /// One cycle towards a target; the command is `q()`.
  KinoptServoStep step(const Placement &target) {
    KinoptServoStep step;
    detail::check(kinopt_servo_step(owner_.get(), target.data(), q_.data(), detail::size(q_.size()), &step));
    return step;
  }
  /// One cycle of a stop.
  KinoptServoStep stop() {
    KinoptServoStep step;
    detail::check(kinopt_servo_stop(owner_.get(), q_.data(), detail::size(q_.size()), &step));
    return step;
  }
  /// Commanded joint positions.
  const Vector &q() const { return q_; }
  /// Limit that determined a joint's motion in the last cycle, such as "upper limit"; empty for none.
  std::string held_by(size_t joint) const {
    return detail::text([this, joint](char *buffer, size_t size, size_t *length) {
      return kinopt_servo_held_by(owner_.get(), joint, buffer, size, length);
    });
  }
  /// Pairs that blocked the motion of the last cycle, or that are in contact, the deepest first.
  std::vector<Collision> collisions() const {
    return detail::collisions(owner_.get(), kinopt_servo_collision_count(owner_.get()), kinopt_servo_collision);
  }
  Vector velocity() const {
    Vector velocity(q_.size());
    detail::check(kinopt_servo_motion(owner_.get(), velocity.data(), nullptr, detail::size(q_.size())));
    return velocity;
  }
  Vector acceleration() const {
    Vector acceleration(q_.size());
    detail::check(kinopt_servo_motion(owner_.get(), nullptr, acceleration.data(), detail::size(q_.size())));
    return acceleration;
  }

private:
  Vector q_;
  detail::Owner<KinoptServo, kinopt_servo_free> owner_;
};

/// Joint positions, velocities and accelerations at a time.
struct TrajectoryPoint {
  Vector q, velocity, acceleration;
};

/// Time-optimal motion along a joint path.
class Trajectory {
public:
  Trajectory(KinoptTrajectory *trajectory, size_t joint_count)
      : joint_count_(detail::index(joint_count)), owner_(trajectory) {}
  double duration() const { return kinopt_trajectory_duration(owner_.get()); }
  TrajectoryPoint at(double time) {
    TrajectoryPoint point{Vector(joint_count_), Vector(joint_count_), Vector(joint_count_)};
    detail::check(kinopt_trajectory_at(owner_.get(), time, point.q.data(), point.velocity.data(),
                                       point.acceleration.data(), detail::size(joint_count_)));
    return point;
  }

private:
  Eigen::Index joint_count_;
  detail::Owner<KinoptTrajectory, kinopt_trajectory_free> owner_;
};

/// A point that the tool does not reach, or only in collision.
struct MissedPoint {
  size_t row = 0;
  /// Errors beyond the goal bounds, metres and radians. They are within the tolerances of a pose reached in collision.
  double position_error = 0.0, orientation_error = 0.0;
  std::string reason;
};

/// A step between rows that is not proven collision-free.
struct BlockedStep {
  /// Row after the step; 0 for the step that closes a cyclic path.
  size_t row = 0;
  /// Colliding pair.
  std::string pair;
};

/// Joint path of a Cartesian path: fewest reconfigurations, then the shortest.
class JointPath {
public:
  JointPath(const Arm &arm, const std::vector<Placement> &points, const Settings &settings = {})
      : joint_count_(arm.joint_count()) {
    KinoptJointPath *path = nullptr;
    const std::vector<double> numbers = detail::numbers(points);
    detail::check(
        kinopt_arm_solve_path(arm.get(), numbers.data(), points.size(), settings.json().c_str(), &path));
    owner_.reset(path);
  }
  /// True if all points are reached without reconfigurations, and all steps are collision-free.
  bool reached() const { return kinopt_joint_path_reached(owner_.get()); }
  /// Configurations, one a row.
  Eigen::Map<const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>> q() const {
    return {kinopt_joint_path_q(owner_.get(), nullptr), detail::index(kinopt_joint_path_row_count(owner_.get())),
            detail::index(joint_count_)};
  }
  std::vector<KinoptJointJump> jumps() const {
    std::vector<KinoptJointJump> jumps(kinopt_joint_path_jump_count(owner_.get()));
    for (size_t k = 0; k < jumps.size(); ++k) detail::check(kinopt_joint_path_jump(owner_.get(), k, &jumps[k]));
    return jumps;
  }
  std::vector<MissedPoint> missed() const {
    std::vector<MissedPoint> all;
    for (size_t k = 0; k < kinopt_joint_path_missed_count(owner_.get()); ++k) {
      KinoptMissedPoint missed;
      detail::check(kinopt_joint_path_missed(owner_.get(), k, &missed));
      all.push_back({missed.index, missed.position_error, missed.orientation_error,
                     kinopt_joint_path_missed_reason(owner_.get(), k)});
    }
    return all;
  }
  std::vector<BlockedStep> blocked() const {
    std::vector<BlockedStep> all(kinopt_joint_path_blocked_count(owner_.get()));
    for (size_t k = 0; k < all.size(); ++k) {
      detail::check(kinopt_joint_path_blocked(owner_.get(), k, &all[k].row));
      all[k].pair = kinopt_joint_path_blocked_pair(owner_.get(), k);
    }
    return all;
  }
  /// Trajectory from rest to rest. Limits have one number a joint; the default is those of the robot's files. Settings:
  /// `corner_tolerance`, `grid_points`, `allow_unreached` (a path with missed points or blocked steps is an error).
  Trajectory trajectory(const Arm &arm, const std::optional<Vector> &velocity_limits = std::nullopt,
                        const std::optional<Vector> &acceleration_limits = std::nullopt,
                        const std::optional<Vector> &jerk_limits = std::nullopt,
                        const Settings &settings = {}) const {
    const size_t count = joint_count_;
    const auto data = [count](const std::optional<Vector> &limits) -> const double * {
      if (!limits) return nullptr;
      if (detail::size(limits->size()) != count) {
        throw Error(KINOPT_STATUS_INVALID_VALUE, "limits have " + std::to_string(limits->size()) +
                                                     " numbers, expected " + std::to_string(count));
      }
      return limits->data();
    };
    KinoptTrajectory *trajectory = nullptr;
    detail::check(kinopt_joint_path_trajectory(owner_.get(), arm.get(), data(velocity_limits),
                                               data(acceleration_limits), data(jerk_limits), count,
                                               settings.json().c_str(), &trajectory));
    return Trajectory(trajectory, count);
  }

private:
  size_t joint_count_;
  detail::Owner<KinoptJointPath, kinopt_joint_path_free> owner_;
};

/// Tasks on a robot, from JSON.
class Problem {
public:
  Problem(const Robot &robot, const std::string &tasks, const Settings &settings = {}) {
    KinoptProblem *problem = nullptr;
    detail::check(kinopt_problem_new(robot.get(), tasks.c_str(), nullptr, nullptr, 0.0, settings.json().c_str(),
                                     &problem));
    owner_.reset(problem);
  }
  /// Problem that avoids collisions by at least `margin` metres.
  Problem(const Robot &robot, const std::string &tasks, const CollisionModel &model, const World &world,
          double margin = 0.0, const Settings &settings = {}) {
    KinoptProblem *problem = nullptr;
    detail::check(kinopt_problem_new(robot.get(), tasks.c_str(), model.get(), world.get(), margin,
                                     settings.json().c_str(), &problem));
    owner_.reset(problem);
  }
  std::vector<std::string> task_names() const {
    std::vector<std::string> names;
    for (size_t k = 0; k < kinopt_problem_task_count(get()); ++k) names.emplace_back(kinopt_problem_task_name(get(), k));
    return names;
  }
  const KinoptProblem *get() const { return owner_.get(); }

private:
  detail::Owner<KinoptProblem, kinopt_problem_free> owner_;
};

/// Targets of a problem that change between queries. The problem must outlive them.
class Targets {
public:
  explicit Targets(const Problem &problem) : problem_(problem.get()) {
    KinoptTargets *targets = nullptr;
    detail::check(kinopt_targets_new(problem_, &targets));
    owner_.reset(targets);
  }
  void set(const std::string &task, const Placement &target) {
    detail::check(kinopt_targets_set_placement(owner_.get(), problem_, task.c_str(), target.data()));
  }
  void set(const std::string &task, const VectorRef &numbers) {
    detail::check(kinopt_targets_set_numbers(owner_.get(), problem_, task.c_str(), numbers.data(),
                                             detail::size(numbers.size())));
  }
  const KinoptTargets *get() const { return owner_.get(); }

private:
  const KinoptProblem *problem_;
  detail::Owner<KinoptTargets, kinopt_targets_free> owner_;
};

/// Solver of problems, with its workspace.
class Solver {
public:
  explicit Solver(const Settings &settings = {}) {
    KinoptSolver *solver = nullptr;
    detail::check(kinopt_solver_new(settings.json().c_str(), &solver));
    owner_.reset(solver);
  }
  void solve(const Problem &problem, const Targets *targets, const VectorRef &start, Solution &solution) {
    detail::check(kinopt_solver_solve(owner_.get(), problem.get(), targets ? targets->get() : nullptr, start.data(),
                                      detail::size(start.size()), solution.get()));
  }
  Solution solve(const Problem &problem, const VectorRef &start) {
    Solution solution;
    solve(problem, nullptr, start, solution);
    return solution;
  }

private:
  detail::Owner<KinoptSolver, kinopt_solver_free> owner_;
};

} // namespace kinopt

#endif // KINOPT_HPP
