// MoveIt 2 kinematics plugin over kinopt. Licence: MIT or Apache-2.0.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <kinopt/kinopt.hpp>
#include <moveit/kinematics_base/kinematics_base.hpp>

namespace kinopt_kinematics_plugin {

/// Inverse kinematics of a MoveIt group that is a chain, with one tip.
///
/// Poses are in the base frame. Joint values are those of the group's joints in the order of getJointNames(), mimic
/// joints included, in radians and metres. Queries may run in several threads at once.
class KinoptKinematicsPlugin : public kinematics::KinematicsBase {
public:
  using Pose = geometry_msgs::msg::Pose;
  using ErrorCode = moveit_msgs::msg::MoveItErrorCodes;
  using Options = kinematics::KinematicsQueryOptions;
  using Values = std::vector<double>;

  KinoptKinematicsPlugin();

  bool initialize(const rclcpp::Node::SharedPtr &node, const moveit::core::RobotModel &robot_model,
                  const std::string &group_name, const std::string &base_frame,
                  const std::vector<std::string> &tip_frames, double search_discretization) override;

  bool supportsGroup(const moveit::core::JointModelGroup *group, std::string *error_text_out = nullptr) const override;

  /// Makes a single attempt, from the seed.
  bool getPositionIK(const Pose &ik_pose, const Values &ik_seed_state, Values &solution, ErrorCode &error_code,
                     const Options &options = Options()) const override;

  /// Finds several solutions of one pose, nearest to the seed first, within the default timeout.
  ///
  /// NO_DISCRETIZATION holds the redundant joints at the seed. ALL_RANDOM_SAMPLED lets them move.
  bool getPositionIK(const std::vector<Pose> &ik_poses, const Values &ik_seed_state, std::vector<Values> &solutions,
                     kinematics::KinematicsResult &result, const Options &options) const override;

  bool searchPositionIK(const Pose &ik_pose, const Values &ik_seed_state, double timeout, Values &solution,
                        ErrorCode &error_code, const Options &options = Options()) const override;

  bool searchPositionIK(const Pose &ik_pose, const Values &ik_seed_state, double timeout,
                        const Values &consistency_limits, Values &solution, ErrorCode &error_code,
                        const Options &options = Options()) const override;

  bool searchPositionIK(const Pose &ik_pose, const Values &ik_seed_state, double timeout, Values &solution,
                        const IKCallbackFn &solution_callback, ErrorCode &error_code,
                        const Options &options = Options()) const override;

  bool searchPositionIK(const Pose &ik_pose, const Values &ik_seed_state, double timeout,
                        const Values &consistency_limits, Values &solution, const IKCallbackFn &solution_callback,
                        ErrorCode &error_code, const Options &options = Options()) const override;

  bool searchPositionIK(const std::vector<Pose> &ik_poses, const Values &ik_seed_state, double timeout,
                        const Values &consistency_limits, Values &solution, const IKCallbackFn &solution_callback,
                        ErrorCode &error_code, const Options &options = Options(),
                        const moveit::core::RobotState *context_state = nullptr) const override;

  /// Returns the solution of the least cost among the first `max_solutions` that the callback accepts.
  bool searchPositionIK(const std::vector<Pose> &ik_poses, const Values &ik_seed_state, double timeout,
                        const Values &consistency_limits, Values &solution, const IKCallbackFn &solution_callback,
                        const IKCostFn &cost_function, ErrorCode &error_code, const Options &options = Options(),
                        const moveit::core::RobotState *context_state = nullptr) const override;

  /// Computes poses of links of the chain, in the base frame.
  bool getPositionFK(const std::vector<std::string> &link_names, const Values &joint_angles,
                     std::vector<Pose> &poses) const override;

  const std::vector<std::string> &getJointNames() const override { return joint_names_; }
  const std::vector<std::string> &getLinkNames() const override { return tip_frames_; }

private:
  /// Parameters of the group, see README.
  struct Parameters {
    double position_tolerance = 1e-6;
    double orientation_tolerance = 1e-6;
    bool position_only_ik = false;
    std::string search = "start";
    int64_t attempts = 0;
    int64_t seed = 0;
    int64_t max_solutions = 16;
    double solution_distance = 0.1;
  };

  /// Source of the value of a joint of the group.
  struct JointSource {
    /// Joint of the arm; none for a joint that the chain does not move, which keeps its seed.
    std::optional<size_t> arm_joint;
    /// Mimic joints: value = factor * source + offset.
    double factor = 1.0;
    double offset = 0.0;
  };

  /// Arms of one chain.
  struct Arms {
    kinopt::Arm search;
    /// Makes one attempt, from the seed.
    kinopt::Arm single_attempt;
    /// Links of the group between base and tip, by name.
    std::vector<std::pair<std::string, kinopt::ArmLink>> links;
  };

  /// Cost function of a search and its arguments.
  struct Cost;

  /// Configuration of the arm; empty if `values` has the wrong length, which is logged as that of `what`.
  std::optional<kinopt::Vector> arm_values(const Values &values, const char *what) const;
  Values group_values(const Eigen::Ref<const kinopt::Vector> &q, const Values &seed) const;
  kinopt::Vector max_move(const Values &consistency_limits, bool lock_redundant_joints) const;
  bool search(const Pose &pose, const Values &seed, double timeout, const Values &consistency_limits, Values &solution,
              const IKCallbackFn &callback, const Cost *cost, ErrorCode &error_code, const Options &options) const;
  Parameters read_parameters(const std::string &group_name) const;
  bool build(const moveit::core::JointModelGroup &group);

  Parameters parameters_;
  std::optional<Arms> arms_;
  const moveit::core::JointModelGroup *group_ = nullptr;
  std::vector<std::string> joint_names_;
  /// One for each joint name.
  std::vector<JointSource> sources_;
  /// Index in the joint names, one for each joint of the arm.
  std::vector<size_t> group_joints_;
};

} // namespace kinopt_kinematics_plugin
