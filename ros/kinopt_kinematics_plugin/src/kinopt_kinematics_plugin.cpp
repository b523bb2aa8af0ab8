// MoveIt 2 kinematics plugin over kinopt. Licence: MIT or Apache-2.0.
#include "kinopt_kinematics_plugin/kinopt_kinematics_plugin.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>

#include <moveit/robot_model/robot_model.hpp>
#include <moveit/robot_state/robot_state.hpp>
#include <pluginlib/class_list_macros.hpp>

#include "kinematic_urdf.hpp"

namespace kinopt_kinematics_plugin {
namespace {

constexpr double UNBOUNDED = std::numeric_limits<double>::infinity();
/// Rounding of a joint value that lies on a consistency limit, radians or metres.
constexpr double LIMIT_ROUNDING = 1e-12;

rclcpp::Logger logger() { return moveit::getLogger("moveit.kinematics.kinopt_kinematics_plugin"); }

/// Value of a parameter, declared with its default if the node does not have it.
template <class T> T parameter(rclcpp::Node &node, const std::string &name, const T &default_value) {
  if (!node.has_parameter(name)) node.declare_parameter(name, default_value);
  return node.get_parameter(name).template get_value<T>();
}

/// Placement of a pose, with a quaternion of any length but zero; none for numbers that are not finite.
std::optional<kinopt::Placement> placement_of(const geometry_msgs::msg::Pose &pose) {
  const Eigen::Vector3d position(pose.position.x, pose.position.y, pose.position.z);
  const Eigen::Quaterniond rotation(pose.orientation.w, pose.orientation.x, pose.orientation.y, pose.orientation.z);
  const double norm = rotation.norm();
  if (!position.allFinite() || !std::isfinite(norm) || norm == 0.0) return std::nullopt;
  kinopt::Placement placement = kinopt::Placement::Identity();
  placement.translation() = position;
  placement.linear() = rotation.normalized().toRotationMatrix();
  return placement;
}

geometry_msgs::msg::Pose pose_of(const kinopt::Placement &placement) {
  const Eigen::Quaterniond rotation(placement.linear());
  geometry_msgs::msg::Pose pose;
  pose.position.x = placement.translation().x();
  pose.position.y = placement.translation().y();
  pose.position.z = placement.translation().z();
  pose.orientation.x = rotation.x();
  pose.orientation.y = rotation.y();
  pose.orientation.z = rotation.z();
  pose.orientation.w = rotation.w();
  return pose;
}

bool within(const kinopt::VectorRef &q, const kinopt::Vector &seed, const kinopt::Vector &max_move) {
  return ((q - seed).array().abs() <= max_move.array()).all();
}

} // namespace

struct KinoptKinematicsPlugin::Cost {
  const IKCostFn &function;
  const moveit::core::RobotState *context_state;
};

KinoptKinematicsPlugin::KinoptKinematicsPlugin() {
  supported_methods_.push_back(kinematics::DiscretizationMethods::ALL_RANDOM_SAMPLED);
}

bool KinoptKinematicsPlugin::supportsGroup(const moveit::core::JointModelGroup *group,
                                           std::string *error_text_out) const {
  const char *problem = nullptr;
  if (!group->isChain()) problem = "kinopt supports groups that are chains";
  else if (!group->isSingleDOFJoints()) problem = "kinopt supports groups of joints with one degree of freedom";
  if (problem && error_text_out) *error_text_out = problem;
  return !problem;
}

KinoptKinematicsPlugin::Parameters KinoptKinematicsPlugin::read_parameters(const std::string &group_name) const {
  const std::string prefix = "robot_description_kinematics." + group_name + ".";
  Parameters read;
  const auto fill = [&](const char *name, auto &value) { value = parameter(*node_, prefix + name, value); };
  fill("position_tolerance", read.position_tolerance);
  fill("orientation_tolerance", read.orientation_tolerance);
  fill("position_only_ik", read.position_only_ik);
  fill("search", read.search);
  fill("attempts", read.attempts);
  fill("seed", read.seed);
  fill("max_solutions", read.max_solutions);
  fill("solution_distance", read.solution_distance);
  if (read.max_solutions < 1) throw std::invalid_argument("`max_solutions` must be at least 1");
  return read;
}

bool KinoptKinematicsPlugin::initialize(const rclcpp::Node::SharedPtr &node,
                                        const moveit::core::RobotModel &robot_model, const std::string &group_name,
                                        const std::string &base_frame, const std::vector<std::string> &tip_frames,
                                        double search_discretization) {
  node_ = node;
  arms_.reset();
  storeValues(robot_model, group_name, base_frame, tip_frames, search_discretization);
  group_ = robot_model.getJointModelGroup(group_name);
  if (!group_) {
    RCLCPP_ERROR(logger(), "There is no group '%s'", group_name.c_str());
    return false;
  }
  std::string problem;
  if (!supportsGroup(group_, &problem)) {
    RCLCPP_ERROR(logger(), "Group '%s': %s", group_name.c_str(), problem.c_str());
    return false;
  }
  if (tip_frames_.size() != 1) {
    RCLCPP_ERROR(logger(), "Group '%s' has %zu tip frames, kinopt supports 1", group_name.c_str(), tip_frames_.size());
    return false;
  }
  try {
    parameters_ = read_parameters(group_name);
    if (!build(*group_)) return false;
    std::string joints;
    for (const std::string &name : joint_names_) joints += " " + name;
    RCLCPP_INFO(logger(), "kinopt %s solves group '%s' from '%s' to '%s', joints:%s", kinopt_version(),
                group_name.c_str(), base_frame_.c_str(), tip_frames_[0].c_str(), joints.c_str());
    return true;
  } catch (const std::exception &error) { // Of kinopt, or a parameter of another type.
    arms_.reset();
    RCLCPP_ERROR(logger(), "Group '%s': %s", group_name.c_str(), error.what());
    return false;
  }
}

bool KinoptKinematicsPlugin::build(const moveit::core::JointModelGroup &group) {
  const urdf::ModelInterface &model = *robot_model_->getURDF();
  const kinopt::Robot robot = kinopt::Robot::parse(kinematic_urdf(model, group), "robot_description");
  // The model frame is no link if a fixed virtual joint connects it to the root link.
  const bool is_model_frame = !model.getLink(base_frame_) && base_frame_ == robot_model_->getModelFrame() &&
                              robot_model_->getRootJoint()->getType() == moveit::core::JointModel::FIXED;
  const std::string base = is_model_frame ? model.getRoot()->name : base_frame_;
  const std::string &tip = tip_frames_[0];

  kinopt::Settings settings;
  settings.set("position_tolerance", parameters_.position_tolerance)
      .set("orientation_tolerance", parameters_.orientation_tolerance)
      .set("goal", parameters_.position_only_ik ? "position" : "pose")
      .set("search", parameters_.search)
      .set("seed", static_cast<int>(parameters_.seed));
  kinopt::Settings single = settings;
  if (parameters_.attempts > 0) settings.set("attempts", static_cast<int>(parameters_.attempts));
  single.set("attempts", 1).set("atlas", false);
  Arms arms{kinopt::Arm(robot, base, tip, settings), kinopt::Arm(robot, base, tip, single), {}};

  const std::vector<std::string> arm_joints = arms.search.joint_names();
  const auto arm_joint = [&](const std::string &name) -> std::optional<size_t> {
    const auto found = std::find(arm_joints.begin(), arm_joints.end(), name);
    if (found == arm_joints.end()) return std::nullopt;
    return static_cast<size_t>(found - arm_joints.begin());
  };
  joint_names_.clear();
  sources_.clear();
  for (const moveit::core::JointModel *joint : group.getJointModels()) {
    if (joint->getVariableCount() != 1) continue;
    JointSource source{arm_joint(joint->getName()), 1.0, 0.0};
    if (const moveit::core::JointModel *mimicked = joint->getMimic()) {
      source = {arm_joint(mimicked->getName()), joint->getMimicFactor(), joint->getMimicOffset()};
    }
    joint_names_.push_back(joint->getName());
    sources_.push_back(source);
  }
  group_joints_.clear();
  for (const std::string &name : arm_joints) {
    const auto found = std::find(joint_names_.begin(), joint_names_.end(), name);
    if (found == joint_names_.end()) {
      RCLCPP_ERROR(logger(), "Joint '%s' is between '%s' and '%s', but not in group '%s'", name.c_str(),
                   base_frame_.c_str(), tip.c_str(), group_name_.c_str());
      return false;
    }
    group_joints_.push_back(static_cast<size_t>(found - joint_names_.begin()));
  }

  std::vector<std::string> links = group.getLinkModelNames();
  for (const std::string &name : {base, tip}) {
    if (std::find(links.begin(), links.end(), name) == links.end()) links.push_back(name);
  }
  for (const std::string &name : links) {
    try {
      arms.links.emplace_back(name, kinopt::ArmLink(robot, base, tip, name));
    } catch (const kinopt::Error &) {
      RCLCPP_DEBUG(logger(), "Link '%s' is not between '%s' and '%s'", name.c_str(), base.c_str(), tip.c_str());
    }
  }
  arms_.emplace(std::move(arms));
  return true;
}

std::optional<kinopt::Vector> KinoptKinematicsPlugin::arm_values(const Values &values, const char *what) const {
  if (values.size() != joint_names_.size()) {
    RCLCPP_ERROR(logger(), "The %s has size %zu, expected %zu", what, values.size(), joint_names_.size());
    return std::nullopt;
  }
  kinopt::Vector q(static_cast<Eigen::Index>(group_joints_.size()));
  for (size_t k = 0; k < group_joints_.size(); ++k) q[static_cast<Eigen::Index>(k)] = values[group_joints_[k]];
  return q;
}

KinoptKinematicsPlugin::Values KinoptKinematicsPlugin::group_values(const Eigen::Ref<const kinopt::Vector> &q,
                                                                    const Values &seed) const {
  Values values = seed;
  for (size_t k = 0; k < sources_.size(); ++k) {
    const JointSource &source = sources_[k];
    if (source.arm_joint) values[k] = source.factor * q[static_cast<Eigen::Index>(*source.arm_joint)] + source.offset;
  }
  return values;
}

/// Largest motion of each joint of the arm from the seed; consistency limits of the right size, or empty.
kinopt::Vector KinoptKinematicsPlugin::max_move(const Values &consistency_limits, bool lock_redundant_joints) const {
  kinopt::Vector largest = kinopt::Vector::Constant(static_cast<Eigen::Index>(group_joints_.size()), UNBOUNDED);
  for (size_t k = 0; k < group_joints_.size(); ++k) {
    double &bound = largest[static_cast<Eigen::Index>(k)];
    if (!consistency_limits.empty()) bound = consistency_limits[group_joints_[k]];
    const auto &redundant = redundant_joint_indices_;
    const bool is_redundant = std::find(redundant.begin(), redundant.end(), group_joints_[k]) != redundant.end();
    if (lock_redundant_joints && is_redundant) bound = 0.0;
  }
  return largest;
}

bool KinoptKinematicsPlugin::search(const Pose &pose, const Values &seed, double timeout,
                                    const Values &consistency_limits, Values &solution, const IKCallbackFn &callback,
                                    const Cost *cost, ErrorCode &error_code, const Options &options) const {
  const auto begin = std::chrono::steady_clock::now();
  error_code.val = ErrorCode::NO_IK_SOLUTION;
  if (!arms_) {
    RCLCPP_ERROR(logger(), "The kinematics solver is not initialized");
    return false;
  }
  const std::optional<kinopt::Vector> q_seed = arm_values(seed, "seed");
  if (!q_seed) return false;
  if (!consistency_limits.empty() && !arm_values(consistency_limits, "vector of consistency limits")) return false;
  const std::optional<kinopt::Placement> target = placement_of(pose);
  if (!target) {
    RCLCPP_ERROR(logger(), "The pose has numbers that are not finite, or a quaternion of zeros");
    return false;
  }
  const kinopt::Vector largest = max_move(consistency_limits, options.lock_redundant_joints);

  Values candidate;
  double least_cost = UNBOUNDED;
  int64_t costed = 0;
  const auto accept = [&](const Eigen::Ref<const kinopt::Vector> &q) {
    // A seed outside the joint limits can be farther than that from all solutions.
    if (!consistency_limits.empty() && !within(q, *q_seed, largest)) return false;
    candidate = group_values(q, seed);
    if (callback) {
      error_code.val = ErrorCode::SUCCESS;
      callback(pose, candidate, error_code);
      if (error_code.val != ErrorCode::SUCCESS) return false;
    }
    if (!cost) {
      solution = candidate;
      return true;
    }
    moveit::core::RobotState state =
        cost->context_state ? *cost->context_state : moveit::core::RobotState(robot_model_);
    if (!cost->context_state) state.setToDefaultValues();
    state.setJointGroupPositions(group_, candidate);
    state.update();
    const double value = cost->function(pose, state, group_, seed);
    if (value < least_cost) {
      least_cost = value;
      solution = candidate;
    }
    return ++costed == parameters_.max_solutions;
  };

  bool found = false;
  try {
    const kinopt::Vector bounds = (largest.array() - LIMIT_ROUNDING).max(0.0);
    const kinopt::Arm arm = timeout > 0.0 ? arms_->search.with_bounds(timeout, bounds)
                                          : arms_->single_attempt.with_bounds(UNBOUNDED, bounds);
    kinopt::Solution result;
    found = arm.solve_accepted(*target, *q_seed, accept, result);
    if (!result.reached() && options.return_approximate_solution) found = accept(result.q());
  } catch (const kinopt::Error &error) {
    RCLCPP_ERROR(logger(), "%s", error.what());
    error_code.val = ErrorCode::NO_IK_SOLUTION;
    return false;
  }
  if (cost) found = least_cost < UNBOUNDED;
  const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - begin;
  if (found) error_code.val = ErrorCode::SUCCESS;
  else if (timeout > 0.0 && elapsed.count() >= timeout) error_code.val = ErrorCode::TIMED_OUT;
  else error_code.val = ErrorCode::NO_IK_SOLUTION;
  return found;
}

bool KinoptKinematicsPlugin::getPositionIK(const Pose &ik_pose, const Values &ik_seed_state, Values &solution,
                                           ErrorCode &error_code, const Options &options) const {
  return search(ik_pose, ik_seed_state, 0.0, {}, solution, nullptr, nullptr, error_code, options);
}

bool KinoptKinematicsPlugin::getPositionIK(const std::vector<Pose> &ik_poses, const Values &ik_seed_state,
                                           std::vector<Values> &solutions, kinematics::KinematicsResult &result,
                                           const Options &options) const {
  solutions.clear();
  result.solution_percentage = 0.0;
  const auto fail = [&](kinematics::KinematicError error) {
    result.kinematic_error = error;
    return false;
  };
  namespace errors = kinematics::KinematicErrors;
  if (!arms_) return fail(errors::SOLVER_NOT_ACTIVE);
  if (ik_poses.empty()) return fail(errors::EMPTY_TIP_POSES);
  if (ik_poses.size() != 1) return fail(errors::MULTIPLE_TIPS_NOT_SUPPORTED);
  const auto method = options.discretization_method;
  if (std::find(supported_methods_.begin(), supported_methods_.end(), method) == supported_methods_.end()) {
    return fail(errors::UNSUPORTED_DISCRETIZATION_REQUESTED);
  }
  const std::optional<kinopt::Vector> q_seed = arm_values(ik_seed_state, "seed");
  const std::optional<kinopt::Placement> target = placement_of(ik_poses[0]);
  if (!q_seed || !target) return fail(errors::NO_SOLUTION);
  try {
    const bool is_locked =
        options.lock_redundant_joints || method == kinematics::DiscretizationMethods::NO_DISCRETIZATION;
    const double timeout = default_timeout_ > 0.0 ? default_timeout_ : UNBOUNDED;
    const kinopt::Arm arm = arms_->search.with_bounds(timeout, max_move({}, is_locked));
    std::vector<kinopt::Vector> chosen;
    for (const kinopt::Vector &q : arm.solve_all(*target, *q_seed).solutions) {
      if (chosen.size() == static_cast<size_t>(parameters_.max_solutions)) break;
      bool is_apart = true;
      for (const kinopt::Vector &other : chosen) is_apart &= (q - other).norm() > parameters_.solution_distance;
      if (!is_apart) continue;
      chosen.push_back(q);
      solutions.push_back(group_values(q, ik_seed_state));
    }
  } catch (const kinopt::Error &error) {
    RCLCPP_ERROR(logger(), "%s", error.what());
    return fail(errors::NO_SOLUTION);
  }
  if (solutions.empty()) return fail(errors::NO_SOLUTION);
  result.kinematic_error = errors::OK;
  result.solution_percentage = 1.0;
  return true;
}

bool KinoptKinematicsPlugin::searchPositionIK(const Pose &ik_pose, const Values &ik_seed_state, double timeout,
                                              Values &solution, ErrorCode &error_code, const Options &options) const {
  return search(ik_pose, ik_seed_state, timeout, {}, solution, nullptr, nullptr, error_code, options);
}

bool KinoptKinematicsPlugin::searchPositionIK(const Pose &ik_pose, const Values &ik_seed_state, double timeout,
                                              const Values &consistency_limits, Values &solution, ErrorCode &error_code,
                                              const Options &options) const {
  return search(ik_pose, ik_seed_state, timeout, consistency_limits, solution, nullptr, nullptr, error_code, options);
}

bool KinoptKinematicsPlugin::searchPositionIK(const Pose &ik_pose, const Values &ik_seed_state, double timeout,
                                              Values &solution, const IKCallbackFn &solution_callback,
                                              ErrorCode &error_code, const Options &options) const {
  return search(ik_pose, ik_seed_state, timeout, {}, solution, solution_callback, nullptr, error_code, options);
}

bool KinoptKinematicsPlugin::searchPositionIK(const Pose &ik_pose, const Values &ik_seed_state, double timeout,
                                              const Values &consistency_limits, Values &solution,
                                              const IKCallbackFn &solution_callback, ErrorCode &error_code,
                                              const Options &options) const {
  return search(ik_pose, ik_seed_state, timeout, consistency_limits, solution, solution_callback, nullptr, error_code,
                options);
}

bool KinoptKinematicsPlugin::searchPositionIK(const std::vector<Pose> &ik_poses, const Values &ik_seed_state,
                                              double timeout, const Values &consistency_limits, Values &solution,
                                              const IKCallbackFn &solution_callback, ErrorCode &error_code,
                                              const Options &options,
                                              const moveit::core::RobotState *context_state) const {
  return searchPositionIK(ik_poses, ik_seed_state, timeout, consistency_limits, solution, solution_callback, IKCostFn(),
                          error_code, options, context_state);
}

bool KinoptKinematicsPlugin::searchPositionIK(const std::vector<Pose> &ik_poses, const Values &ik_seed_state,
                                              double timeout, const Values &consistency_limits, Values &solution,
                                              const IKCallbackFn &solution_callback, const IKCostFn &cost_function,
                                              ErrorCode &error_code, const Options &options,
                                              const moveit::core::RobotState *context_state) const {
  if (ik_poses.size() != 1) {
    RCLCPP_ERROR(logger(), "There are %zu poses, kinopt supports 1", ik_poses.size());
    error_code.val = ErrorCode::NO_IK_SOLUTION;
    return false;
  }
  const Cost cost{cost_function, context_state};
  return search(ik_poses[0], ik_seed_state, timeout, consistency_limits, solution, solution_callback,
                cost_function ? &cost : nullptr, error_code, options);
}

bool KinoptKinematicsPlugin::getPositionFK(const std::vector<std::string> &link_names, const Values &joint_angles,
                                           std::vector<Pose> &poses) const {
  if (!arms_) {
    RCLCPP_ERROR(logger(), "The kinematics solver is not initialized");
    return false;
  }
  const std::optional<kinopt::Vector> q = arm_values(joint_angles, "vector of joint angles");
  if (!q) return false;
  poses.assign(link_names.size(), Pose());
  for (size_t k = 0; k < link_names.size(); ++k) {
    const auto is_link = [&](const auto &link) { return link.first == link_names[k]; };
    const auto found = std::find_if(arms_->links.begin(), arms_->links.end(), is_link);
    if (found == arms_->links.end()) {
      RCLCPP_ERROR(logger(), "Link '%s' is not between '%s' and '%s'", link_names[k].c_str(), base_frame_.c_str(),
                   tip_frames_[0].c_str());
      return false;
    }
    try {
      poses[k] = pose_of(found->second.base_from_link(*q));
    } catch (const kinopt::Error &error) { // Joint angles that are not finite.
      RCLCPP_ERROR(logger(), "%s", error.what());
      return false;
    }
  }
  return true;
}

} // namespace kinopt_kinematics_plugin

PLUGINLIB_EXPORT_CLASS(kinopt_kinematics_plugin::KinoptKinematicsPlugin, kinematics::KinematicsBase)
